/* SPDX-License-Identifier: Apache-2.0 */
/* libc3de: simulations inside another program. Units are SI: m, kg, s, N, Pa.
 *
 *  - Every function returns a c3de_status: 0: success, > 0: success with a warning, < 0: failure.
 *    c3de_embed_last_error() is the text of the last failure on the calling thread: what is wrong, where, which value,
 *    what is accepted.
 *  - Any thread may call. Calls to the same simulation are serialised; those to different simulations run at the same
 *    time.
 *  - The library prints nothing, never ends the process, installs no signal handler, and leaves locale and
 *    floating-point environment of the caller as they are. It opens no window and uses no OpenGL.
 *  - A struct begins with `size`, which the caller sets to sizeof: at most `size` bytes are written; members beyond
 *    `size` of an input struct are taken as 0. New members go last. Reserved members are 0.
 *  - Text is UTF-8, null-terminated. Text and arrays that are returned belong to the simulation and are valid until the
 *    next call that steps, resets, changes or closes it, unless a comment says otherwise.
 *  - c3de_sim is a number and may be copied. A closed handle makes every function return C3DE_E_STALE. */
#ifndef C3DE_EMBED_H
#define C3DE_EMBED_H

#include "c3de/abi/base.h"

#if defined(_WIN32) && !defined(C3DE_EMBED_BUILD)
#define C3DE_EMBED_API C3DE_EXTERN_C __declspec(dllimport)
#else
#define C3DE_EMBED_API C3DE_EXPORT
#endif

/* Grows by 1 with every addition; functions and members are never removed. */
#define C3DE_EMBED_REV 3u

typedef uint64_t c3de_sim; /* 0: none */

/* Progress of long work: fraction 0 ... 1, negative: unknown; what is being done. Any non-zero value cancels the work,
 * which then returns C3DE_E_CANCELLED. Called on the thread that does the work. It may read the simulation if it is
 * given one that is open, and must not step, change or close it (C3DE_E_STATE). */
typedef int32_t(C3DE_CALL *c3de_embed_progress)(void *self, double fraction, const char *what);

#define C3DE_EMBED_NO_PLUGIN_SEARCH 1u /* only plugin_files are loaded */

typedef struct c3de_embed_options {
  uint32_t size;
  uint32_t flags;   /* C3DE_EMBED_NO_PLUGIN_SEARCH */
  const char *file; /* a scene (.toml), a session (.c3de), a recording (.c3dr) or a mesh; with `text`: only the name
                     * for messages, in the folder that relative paths refer to */
  const char *text; /* null, or a scene as TOML that is read instead of the file */
  const char *const *assign; /* [assign_n] "PATH=VALUE", as `c3de run --set` */
  uint64_t assign_n;
  const char *const *plugin_files; /* [plugin_files_n] loaded first; each must load */
  uint64_t plugin_files_n;
  const char *const *plugin_folders; /* [plugin_folders_n] searched before C3DE_PLUGIN_PATH, the folder of the user, and
                                      * c3de/plugins beside the library */
  uint64_t plugin_folders_n;
  uint32_t threads; /* number of worker threads; 0: as many as the machine has */
  uint32_t reserved;
  c3de_embed_progress progress; /* may be null */
  void *progress_self;
} c3de_embed_options;

typedef struct c3de_embed_status {
  uint32_t size;
  uint32_t flags;      /* C3DE_EMBED_LOAD_STEPS, C3DE_EMBED_FINISHED */
  uint64_t steps;      /* since the initial state */
  double time_s, dt_s; /* simulated; size of the next step */
  uint64_t bodies;
  uint64_t generation;    /* of views: changes with every call that may change the state */
  uint32_t stopped;       /* bodies that stay in their last good state while the others continue; events say why */
  uint32_t planned_steps; /* to the end; 0: unknown */
  double wall_s;          /* spent in steps since the simulation was opened */
} c3de_embed_status;

#define C3DE_EMBED_LOAD_STEPS 1u /* quasi-static: steps increase the load, time stays 0 */
#define C3DE_EMBED_FINISHED 2u   /* the solution is complete; further steps have no effect */

/* Called after a step. fraction: completed part of the run, 0 ... 1. Any non-zero value ends the run with
 * C3DE_E_CANCELLED; the state stays complete. */
typedef int32_t(C3DE_CALL *c3de_embed_stepped)(void *self, const c3de_embed_status *status, double fraction);

typedef struct c3de_embed_run_options {
  uint32_t size;
  uint32_t reserved;
  uint64_t max_steps;         /* 0: no limit */
  double until_s;             /* absolute simulated time to reach, ignored for quasi-static solutions; 0: no limit.
                               * Both limits 0: a run ends with C3DE_EMBED_FINISHED or at 1 s, and a replay at the end
                               * of the recording */
  c3de_embed_stepped stepped; /* may be null */
  void *stepped_self;
  double stepped_every_s; /* wall time between two calls, at least; 0: after every step */
} c3de_embed_run_options;

#define C3DE_EMBED_NUMBER 1u  /* number */
#define C3DE_EMBED_INTEGER 2u /* number */
#define C3DE_EMBED_BOOL 3u    /* number: 0 or 1 */
#define C3DE_EMBED_CHOICE 4u  /* text */
#define C3DE_EMBED_TEXT 5u    /* text */
#define C3DE_EMBED_VECTOR 6u  /* vector */

typedef struct c3de_embed_value {
  uint32_t size;
  uint32_t type; /* C3DE_EMBED_NUMBER ...; a number that is "auto" is C3DE_EMBED_TEXT */
  double number;
  double vector[3];
  const char *text; /* the value as text, without unit, of every type */
} c3de_embed_value;

typedef struct c3de_embed_parameter {
  uint32_t size;
  uint32_t type;        /* C3DE_EMBED_NUMBER ... */
  const char *path;     /* of c3de_embed_get() and c3de_embed_set() */
  const char *unit;     /* SI; empty: none */
  const char *label;    /* for people */
  const char *meaning;  /* effect of small and large values */
  const char *accepted; /* "0 < value < 0.5", "stvk | neo_hookean" */
} c3de_embed_parameter;

typedef struct c3de_embed_body {
  uint32_t size;
  uint32_t reserved;
  const char *name; /* valid until the simulation is closed */
  uint64_t points, surface_points, triangles;
  double mass_kg, volume_m3, spacing_m, stable_dt_s;
} c3de_embed_body;

#define C3DE_EMBED_ON_POINTS 1u  /* material points (mass) */
#define C3DE_EMBED_ON_SURFACE 2u /* vertices of the surface mesh */

typedef struct c3de_embed_field {
  uint32_t size;
  uint32_t comps;   /* 1; 3: a vector; 9: a matrix, column-major */
  const char *name; /* "position" */
  const char *unit; /* SI, "1" for a ratio */
} c3de_embed_field;

/* A view of numbers in row-major order. Its memory is valid until the next call that steps, resets, changes or closes
 * the simulation: as long as `generation` is that of c3de_embed_get_status(). */
typedef struct c3de_embed_array {
  uint32_t size;
  uint32_t dtype; /* C3DE_F64, C3DE_U32 */
  const void *data;
  uint32_t rank; /* 1 or 2 */
  uint32_t reserved;
  uint64_t shape[2];  /* rows, comps */
  int64_t strides[2]; /* bytes */
  const char *unit;   /* SI; valid until the simulation is closed */
  uint64_t generation;
} c3de_embed_array;

/* Springs between a part of a body and a position that the caller moves. */
typedef struct c3de_embed_hold {
  uint32_t size;
  uint32_t flags;       /* C3DE_EMBED_HOLD_SHAPE */
  double at_m[3];       /* centre of the ball whose points are held, in the current configuration, m */
  double radius_m;      /* > 0 */
  double frequency_hz;  /* of the springs on the mass they hold; 0: chosen automatically */
  double damping_ratio; /* 1: critical; 0: chosen automatically */
  double max_force_N;   /* 0: chosen automatically such that it does not tear the body apart */
} c3de_embed_hold;

/* What is held keeps its shape; otherwise only the weighted mean position is controlled. */
#define C3DE_EMBED_HOLD_SHAPE 1u

typedef struct c3de_embed_hold_state {
  uint32_t size;
  uint32_t reserved;
  double point_m[3];  /* current position of the hold point `at_m` */
  double target_m[3]; /* where it is pulled to */
  double force_N[3];  /* of the last step, on the body */
  double mass_kg;     /* that is held */
} c3de_embed_hold_state;

/* ---- the library ---- */

C3DE_EMBED_API uint32_t c3de_embed_revision(void);      /* C3DE_EMBED_REV of the library */
C3DE_EMBED_API const char *c3de_embed_version(void);    /* of the product; static */
C3DE_EMBED_API const char *c3de_embed_last_error(void); /* never null; valid until the next call on this thread */
/* Receives messages that are not errors of a call, such as a plugin that was refused: level 0 debug, 1 information, 2
 * warning, 3 error. Null: none. For the whole process; called on any thread, and must not call the library. */
C3DE_EMBED_API void c3de_embed_set_log(void(C3DE_CALL *log)(void *self, int32_t level, const char *line), void *self);

/* ---- opening and closing ---- */

/* Builds a simulation. C3DE_E_FORMAT: a file is unreadable or refused; C3DE_E_ARG: an assignment or option;
 * C3DE_E_NOT_FOUND: a plugin. `out` is 0 after a failure. */
C3DE_EMBED_API c3de_status c3de_embed_open(const c3de_embed_options *options, c3de_sim *out);
/* Cancels a run on another thread and waits for it. Returned text and views become invalid. 0: does nothing. Refused
 * from within a callback of the simulation (C3DE_E_STATE), which then stays open. */
C3DE_EMBED_API c3de_status c3de_embed_close(c3de_sim sim);

/* ---- parameters ---- */

C3DE_EMBED_API c3de_status c3de_embed_parameter_count(c3de_sim sim, uint64_t *out);
C3DE_EMBED_API c3de_status c3de_embed_parameter_at(c3de_sim sim, uint64_t index, c3de_embed_parameter *out);
C3DE_EMBED_API c3de_status c3de_embed_get(c3de_sim sim, const char *path, c3de_embed_value *out);
/* text: as after `--set PATH=`. Parameters that take effect only when the scene is built are refused (C3DE_E_ARG).
 * Nothing has changed after a refusal. */
C3DE_EMBED_API c3de_status c3de_embed_set(c3de_sim sim, const char *path, const char *text);

/* ---- running ---- */

C3DE_EMBED_API c3de_status c3de_embed_get_status(c3de_sim sim, c3de_embed_status *out);
/* Up to n steps; fewer when the solution is complete. done: steps that were made, also before a failure; may be null. A
 * step that fails (C3DE_E_DIVERGED, C3DE_E_TIMEOUT, ...) leaves the state before it. Bodies that have stopped while
 * others continue are no failure here: `stopped` of c3de_embed_status counts them. */
C3DE_EMBED_API c3de_status c3de_embed_step(c3de_sim sim, uint64_t n, uint64_t *done);
/* options null: all 0. C3DE_E_DIVERGED also where bodies have stopped at the end; all steps were made then, and the
 * state is complete. */
C3DE_EMBED_API c3de_status c3de_embed_run(c3de_sim sim, const c3de_embed_run_options *options);
/* Ends the step, run, replay, match, fit, sensitivity or warp of another thread with C3DE_E_CANCELLED, within a second
 * or so; without one it has no effect. Does not wait. A build that c3de_embed_open() makes is cancelled by its progress
 * function. */
C3DE_EMBED_API c3de_status c3de_embed_cancel(c3de_sim sim);
C3DE_EMBED_API c3de_status c3de_embed_reset(c3de_sim sim); /* to the initial state, bit for bit */
/* Hash of the complete simulation state: equal to `state_hash` in the report of `c3de run` after the same steps. */
C3DE_EMBED_API c3de_status c3de_embed_state_hash(c3de_sim sim, uint64_t *out);

/* ---- bodies and fields ---- */

C3DE_EMBED_API c3de_status c3de_embed_body_at(c3de_sim sim, uint64_t index, c3de_embed_body *out);
C3DE_EMBED_API c3de_status c3de_embed_find_body(c3de_sim sim, const char *name, uint64_t *index); /* C3DE_E_NOT_FOUND */
/* on: C3DE_EMBED_ON_POINTS or C3DE_EMBED_ON_SURFACE. C3DE_E_NOT_FOUND after the last. */
C3DE_EMBED_API c3de_status c3de_embed_field_at(c3de_sim sim, uint64_t body, uint32_t on, uint64_t index,
                                               c3de_embed_field *out);
/* A field as f64. Every body has "position" and "reference_position" (m), and "displacement", their difference. The
 * simulator writes the numbers once after a change of the state; further calls return the same memory. */
C3DE_EMBED_API c3de_status c3de_embed_view_field(c3de_sim sim, uint64_t body, uint32_t on, const char *name,
                                                 c3de_embed_array *out);
/* The same into caller-provided memory, contiguous, [rows][comps] f64. bytes: of that memory; C3DE_E_ARG if it is
 * another size. */
C3DE_EMBED_API c3de_status c3de_embed_read_field(c3de_sim sim, uint64_t body, uint32_t on, const char *name,
                                                 double *data, uint64_t bytes);
/* Surface triangles, u32, between points of the surface, outwards by the right-hand rule. */
C3DE_EMBED_API c3de_status c3de_embed_view_triangles(c3de_sim sim, uint64_t body, c3de_embed_array *out);

/* ---- events, report, states ---- */

C3DE_EMBED_API c3de_status c3de_embed_events(c3de_sim sim, const char **json); /* array of {time_s, kind, text} */
C3DE_EMBED_API c3de_status c3de_embed_report(c3de_sim sim, const char **json); /* as `c3de run --report` */
C3DE_EMBED_API c3de_status c3de_embed_save_state(c3de_sim sim, const char *file);
/* Of the same scene; every step after it is as it was after saving, bit for bit. Nothing changes on an error. */
C3DE_EMBED_API c3de_status c3de_embed_load_state(c3de_sim sim, const char *file);
/* A session (.c3de) with scene, changes and state, for `c3de FILE.c3de`, `c3de run` and c3de_embed_open(). */
C3DE_EMBED_API c3de_status c3de_embed_save_session(c3de_sim sim, const char *file);

/* ---- pulling and holding ---- */

/* Positions are in m in the frame of the world, forces in N. C3DE_E_UNSUPPORTED: the simulator cannot hold bodies;
 * C3DE_E_STALE: the hold has ended, because it was released or the simulation was reset. */

/* Attaches springs to the points of a body in a ball; their target is `at_m` until c3de_embed_pull(). C3DE_E_NOT_FOUND:
 * there is no such body; C3DE_E_ARG: a value of `hold` is refused; C3DE_E_STATE: the body cannot be pulled, as a fixed
 * rigid one. */
C3DE_EMBED_API c3de_status c3de_embed_hold_body(c3de_sim sim, uint64_t body, const c3de_embed_hold *hold,
                                                uint64_t *out);
/* target_m: [3], position that the hold point `at_m` is pulled to from the next step on. C3DE_E_ARG: not finite. */
C3DE_EMBED_API c3de_status c3de_embed_pull(c3de_sim sim, uint64_t hold, const double *target_m);
/* Position of the hold point, its target, the force on the body in the last step, and the mass that is held (kg). */
C3DE_EMBED_API c3de_status c3de_embed_hold_read(c3de_sim sim, uint64_t hold, c3de_embed_hold_state *out);
/* Removes the springs. */
C3DE_EMBED_API c3de_status c3de_embed_release(c3de_sim sim, uint64_t hold);

/* ---- revision 2: supports and loads ---- */

/* On a part of the surface of a body, set while the body is simulated. They persist over a reset, and sessions and
 * recordings contain them. */
#define C3DE_EMBED_SUPPORT 1u      /* holds the part where it is now */
#define C3DE_EMBED_DISPLACEMENT 2u /* moves it by `vector` (m) from where it is now, at constant velocity */
#define C3DE_EMBED_FORCE 3u        /* `vector` (N) in total, distributed by area */
#define C3DE_EMBED_PRESSURE 4u     /* `pressure_Pa` along the present normal, positive into the body */

#define C3DE_EMBED_AT_REST 1u /* of a support: returns the part to its reference position during the ramp */

/* Either vertices or the box. Positions are those of the reference, as `reference_position` of the surface. */
typedef struct c3de_embed_condition {
  uint32_t size;
  uint32_t flags; /* C3DE_EMBED_AT_REST */
  uint32_t kind;  /* C3DE_EMBED_SUPPORT ... */
  uint32_t reserved;
  const char *name;         /* for messages and reports; null: chosen automatically */
  const uint32_t *vertices; /* null, or [vertices_n] of the surface: the triangles whose corners are all among them */
  uint64_t vertices_n;
  double box_min_m[3], box_max_m[3]; /* without vertices: the surface inside this box, cut at its faces */
  double vector[3];                  /* magnitude up to 1e5 N, or 1 m */
  double pressure_Pa;                /* magnitude up to 1e7 Pa */
  double ramp_s; /* 0 ... 3600: simulated time from now on until the value is reached. Quasi-static: the load factor
                  * multiplies a force or pressure, and this is of no effect on it */
} c3de_embed_condition;

typedef struct c3de_embed_condition_state {
  uint32_t size;
  uint32_t reserved;
  double area_m2;      /* in the reference */
  double force_N[3];   /* on the body now: the reaction of a support, the resultant of a load */
  const char *warning; /* why it has no effect; empty: it has one */
} c3de_embed_condition_state;

/* Adds one, or replaces an earlier one. condition: 0, which becomes the number of the new one, or the number of the one
 * that is replaced; from an equal part and kind the value changes continuously during the ramp. C3DE_E_NOT_FOUND: there
 * is no such body; C3DE_E_ARG: a value is refused, no part of the surface is chosen, or it overlaps a support that
 * moves it elsewhere; C3DE_E_STALE: the condition with this number was removed; C3DE_E_STATE: the body cannot move;
 * C3DE_E_UNSUPPORTED: the simulator sets none. Nothing has changed after a refusal. */
C3DE_EMBED_API c3de_status c3de_embed_set_condition(c3de_sim sim, uint64_t body, const c3de_embed_condition *what,
                                                    uint64_t *condition);
/* C3DE_E_STALE: it was removed, or its body was. */
C3DE_EMBED_API c3de_status c3de_embed_condition_read(c3de_sim sim, uint64_t condition, c3de_embed_condition_state *out);
C3DE_EMBED_API c3de_status c3de_embed_remove_condition(c3de_sim sim, uint64_t condition);

/* ---- revision 2: the deformed scan ---- */

typedef uint64_t c3de_image; /* 0: none */

#define C3DE_EMBED_IMAGE 1u  /* the image of [image] of the scene */
#define C3DE_EMBED_LABELS 2u /* its label map, on the grid of the image: the nearest label */

#define C3DE_EMBED_VOXEL_I8 1u
#define C3DE_EMBED_VOXEL_U8 2u
#define C3DE_EMBED_VOXEL_I16 3u
#define C3DE_EMBED_VOXEL_U16 4u
#define C3DE_EMBED_VOXEL_I32 5u
#define C3DE_EMBED_VOXEL_U32 6u
#define C3DE_EMBED_VOXEL_F32 7u
#define C3DE_EMBED_VOXEL_F64 8u

/* A layer of a warped image. Memory and text belong to the image and are valid until it is closed. */
typedef struct c3de_embed_voxels {
  uint32_t size;
  uint32_t type;     /* C3DE_EMBED_VOXEL_* */
  const void *data;  /* contiguous, i fastest */
  uint64_t shape[3]; /* along i, j, k */
  int64_t strides[3];
  double affine[16];       /* row-major: voxel (i, j, k, 1) to mm in RAS (right, anterior, superior), as in NIfTI */
  double slope, intercept; /* value = slope * voxel + intercept */
  const char *unit;        /* of the values, "HU"; empty: unknown */
  uint64_t layers;         /* of this image; above 1 only for overlapping labels */
  uint64_t labels;         /* that occur in this layer, without the background 0 */
} c3de_embed_voxels;

typedef struct c3de_embed_label {
  uint32_t size;
  uint32_t value;
  const char *name;
  float colour[3]; /* linear RGB, 0 ... 1 */
  uint32_t reserved;
} c3de_embed_label;

/* The scan deformed with the bodies as they are now: the voxels that `c3de run --export-image` and `--export-labels`
 * write. The image remains when the simulation continues or is closed. c3de_embed_cancel() ends it, too.
 * C3DE_E_ARG: the scene has no image, or no labels. progress: may be null. */
C3DE_EMBED_API c3de_status c3de_embed_warp(c3de_sim sim, uint32_t what, c3de_embed_progress progress,
                                           void *progress_self, c3de_image *out);
/* C3DE_E_NOT_FOUND after the last layer, or label. */
C3DE_EMBED_API c3de_status c3de_embed_image_voxels(c3de_image image, uint64_t layer, c3de_embed_voxels *out);
C3DE_EMBED_API c3de_status c3de_embed_image_label(c3de_image image, uint64_t layer, uint64_t index,
                                                  c3de_embed_label *out);
/* .nrrd, .nii, .nii.gz or .mha; further layers are written beside it as NAME-2, NAME-3, ... */
C3DE_EMBED_API c3de_status c3de_embed_image_save(c3de_image image, const char *file);
C3DE_EMBED_API c3de_status c3de_embed_image_close(c3de_image image); /* 0: does nothing */

/* ---- revision 2: recordings ---- */

/* Records from now on into a file (.c3dr): the present state, then every change, step, reset and loaded state, and a
 * hash of the state every hash_every steps (0: 100). C3DE_E_ARG: the name does not end with .c3dr; C3DE_E_STATE: it is
 * being recorded already; C3DE_E_IO: the file cannot be written. */
C3DE_EMBED_API c3de_status c3de_embed_record(c3de_sim sim, const char *file, uint64_t hash_every);
/* Completes the file. Returns the error that has ended the recording early, such as a full disk; the simulation is not
 * affected by it. Without a recording it does nothing. Closing a simulation does the same. */
C3DE_EMBED_API c3de_status c3de_embed_end_recording(c3de_sim sim);

typedef struct c3de_embed_replay_state {
  uint32_t size;
  uint32_t flags;        /* C3DE_EMBED_REPLAY_END */
  uint64_t steps;        /* of the recording that were repeated */
  uint64_t equal_hashes; /* state hashes that were compared and are equal */
  const char *remark;    /* "ends early, after step 300"; empty: the recording is complete */
} c3de_embed_replay_state;

#define C3DE_EMBED_REPLAY_END 1u /* everything is repeated */

/* Repeats a recording that c3de_embed_open() has opened, from its present step to its end, or to the limits of
 * `options`. Every recorded state hash is compared. C3DE_E_DIVERGED: the first one differs, and the text names its
 * step. C3DE_E_STATE: the simulation is of no recording. out: may be null. */
C3DE_EMBED_API c3de_status c3de_embed_replay(c3de_sim sim, const c3de_embed_run_options *options,
                                             c3de_embed_replay_state *out);

/* ---- revision 3: measurements (not for clinical use) ---- */

#define C3DE_EMBED_MATCH_IN_PLACE 1u   /* the position is given: the rigid motion is not searched for */
#define C3DE_EMBED_MATCH_RIGID_ONLY 2u /* the body is not deformed */
#define C3DE_EMBED_MATCH_FIT 4u        /* landmarks take part in the fit; otherwise they only evaluate the result */
/* Starts from motion and deformation of the last match of this simulation and body, as for the next frame of a
 * sequence:
 * no rigid search is made. Without an earlier usable match it has no effect. */
#define C3DE_EMBED_MATCH_CONTINUE 8u

/* What was measured of the surface of a body; either points or a file. */
typedef struct c3de_embed_match_options {
  uint32_t size;
  uint32_t flags;         /* C3DE_EMBED_MATCH_* */
  const double *points_m; /* [points_n][3] */
  const double *normals;  /* [points_n][3]; null: not measured. Used by the rigid search, without their sign */
  uint64_t points_n;
  const char *points_file;   /* null, or a CSV x,y,z in mm, or fiducials of 3D Slicer, as `c3de match --points` */
  const double *landmarks_m; /* [landmarks_n][3], in the body at rest */
  const double *measured_m;  /* [landmarks_n][3], where they were measured */
  const char *const *names;  /* [landmarks_n], or null: "1", "2", ... */
  uint64_t landmarks_n;
  double noise_m;               /* > 0: standard deviation of a point; 0: 1 mm */
  double landmark_weight;       /* points that a fitted landmark counts as in the rigid search; 0: 10 */
  c3de_embed_progress progress; /* may be null */
  void *progress_self;
} c3de_embed_match_options;

/* Matches a body to what was measured. The simulation is then in the matched state, held by the forces that were found,
 * if `verdict` is found, unexplained or given. json: `match` of the report of `c3de match`, lengths in mm.
 * C3DE_E_NOT_FOUND: there is no such body; C3DE_E_ARG: a value is refused; C3DE_E_FORMAT: the file is unreadable, or
 * the points cannot be used; C3DE_E_UNSUPPORTED: the simulator matches no bodies; C3DE_E_CANCELLED. Nothing has changed
 * after a failure. */
C3DE_EMBED_API c3de_status c3de_embed_match(c3de_sim sim, uint64_t body, const c3de_embed_match_options *options,
                                            const char **json);

#define C3DE_EMBED_FIT_WATCHED 1u /* watched_m is set */

/* A measured loading curve, in its order; either arrays or a file. Either one [[fix]] of the scene moves, and its
 * reaction was measured, or one [[load]] acts, and the displacement of a material point was measured. */
typedef struct c3de_embed_fit_options {
  uint32_t size;
  uint32_t flags;                /* C3DE_EMBED_FIT_WATCHED */
  const double *displacements_m; /* [points_n] */
  const double *forces_N;        /* [points_n] */
  uint64_t points_n;
  const char *curve_file;       /* null, or a CSV with displacement_mm and force_N, as `c3de fit --curve` */
  double watched_m[3];          /* with a load: reference position of the material point */
  double noise;                 /* standard deviation of the measurement noise, N or m; 0: not known */
  c3de_embed_progress progress; /* may be null */
  void *progress_self;
} c3de_embed_fit_options;

/* Fits the Young's moduli of a body; the simulation does not change. json: `fit` of the report of `c3de fit`.
 * C3DE_E_FORMAT: a value of the curve or the scene is refused; otherwise errors as for c3de_embed_match(). */
C3DE_EMBED_API c3de_status c3de_embed_fit(c3de_sim sim, uint64_t body, const c3de_embed_fit_options *options,
                                          const char **json);

/* Derivatives of an objective at the present static solution by the adjoint method. objective: [points_n][3],
 * derivative with respect to the displacement of each material point (1/m times its unit). forces: [points_n][3], with
 * respect to a force on each (1/N). json: object with `supports` (`fix`, `displacement` per m, `rotation` per rad about
 * `centre_m`), `foundation` (`stiffness`, `tangential`, per Pa/m) and `moduli` (`material`, `value` per Pa).
 * C3DE_E_STATE: the solution is not static, or has contact or flow, which are not differentiated. c3de_embed_cancel()
 * ends it. */
C3DE_EMBED_API c3de_status c3de_embed_sensitivity(c3de_sim sim, uint64_t body, const double *objective,
                                                  uint64_t points_n, double *forces, const char **json);

#endif
