/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulator answers. Units are SI throughout: m, kg, s, N, Pa. */
#ifndef C3DE_ABI_IFACE_SIMULATOR_H
#define C3DE_ABI_IFACE_SIMULATOR_H

#include "../jobs.h"
#include "../object.h"
#include "../params.h"

#define C3DE_IFACE_SIMULATOR_ID "c3de.iface.simulator/1"

#define C3DE_SIM_SCOPE_WORLD 1u    /* gravity, box, solver */
#define C3DE_SIM_SCOPE_BODY 2u     /* material, sampling */
#define C3DE_SIM_SCOPE_OBSTACLE 3u /* friction */

#define C3DE_SIM_REGION_EVERYWHERE 0u
#define C3DE_SIM_REGION_BOX 1u        /* a: min, b: max */
#define C3DE_SIM_REGION_SPHERE 2u     /* a: centre, radius */
#define C3DE_SIM_REGION_HALF_SPACE 3u /* a: point, b: normal; the side the normal points away from */
#define C3DE_SIM_REGION_FILL 4u /* fill: more than half of a voxel, placed as the body; of its parts and fixes alone */

/* A part of space in material coordinates (the body's placed reference shape), m. */
typedef struct c3de_sim_region {
  uint32_t size;
  uint32_t kind; /* C3DE_SIM_REGION_* */
  double a[3], b[3], radius;
  const struct c3de_sim_fill *fill; /* may be absent (by size) */
} c3de_sim_region;

#define C3DE_SIM_HAS_CENTRE 1u     /* centre_m is given; else the centroid of the part */
#define C3DE_SIM_HAS_QUATERNION 2u /* quaternion counts, rotation_deg does not */

/* A rigid motion that is reached at the end of the ramp and kept: rotation through the centre, then displacement. The
 * rotation is about x, then y, then z by angles that grow with the ramp, or about one axis, the shorter way, to a
 * quaternion. Quasi-static: the load factor takes the place of the ramp. */
typedef struct c3de_sim_motion {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_HAS_CENTRE */
  double displacement_m[3], rotation_deg[3], centre_m[3];
  double ramp_s;        /* >= 0; 0: at once */
  double quaternion[4]; /* may be absent (by size). x, y, z, w; of unit length to 1e-6 */
} c3de_sim_motion;

#define C3DE_SIM_PLACED_BY_MATRIX 1u /* matrix counts; position, rotation and scale do not */

/* Where the mesh of a body or obstacle lies: scale, then rotation about x, y, z, then position. */
typedef struct c3de_sim_placement {
  uint32_t size;
  uint32_t flags;                               /* C3DE_SIM_PLACED_BY_MATRIX */
  double position_m[3], rotation_deg[3], scale; /* scale 0 means 1 */
  double matrix[16]; /* column-major, m from the mesh as m: a rotation times one scale > 0, then a displacement */
} c3de_sim_placement;

typedef struct c3de_sim_fix { /* the continuum of the region follows the motion */
  uint32_t size;
  uint32_t index; /* its number in reports */
  c3de_str name;  /* may be empty */
  const c3de_sim_region *region;
  const c3de_sim_motion *motion; /* null: stands still */
} c3de_sim_fix;

#define C3DE_SIM_LOAD_PRESSURE 1u /* pressure_Pa counts, else force_N */
#define C3DE_SIM_LOAD_DEAD 2u     /* the pressure keeps its direction and reference area; else it follows the surface */

typedef struct c3de_sim_load {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_LOAD_* */
  uint32_t index; /* its number in messages */
  uint32_t reserved;
  c3de_str name; /* may be empty */
  const c3de_sim_region *region;
  double force_N[3];  /* total over the region */
  double pressure_Pa; /* pushes into the body */
  double ramp_s;
} c3de_sim_load;

typedef struct c3de_sim_part { /* another material in a region; later ones win */
  uint32_t size;
  uint32_t params_stride;
  const c3de_sim_region *region;
  const c3de_param_value *params; /* ids "material.…" of C3DE_SIM_SCOPE_BODY; what is missing is as in the body */
  uint64_t params_n;
  c3de_str name; /* may be absent (by size), or empty. Of a tissue, for people */
} c3de_sim_part;

typedef struct c3de_sim_refinement { /* finer sampling in a region */
  uint32_t size;
  uint32_t reserved;
  const c3de_sim_region *region;
  double spacing_m;
} c3de_sim_refinement;

/* A regular grid in the frame of the simulation, m. */
typedef struct c3de_sim_grid {
  uint32_t size;
  uint32_t reserved;
  uint64_t points[3];                           /* along i, j, k; i fastest; each at least 1 */
  double origin_m[3];                           /* of point (0, 0, 0) */
  double step_i_m[3], step_j_m[3], step_k_m[3]; /* to the next point; they span space */
} c3de_sim_grid;

/* How much of every voxel belongs to a body: partial volumes count partially, and the volume is theirs, exactly. */
typedef struct c3de_sim_fill {
  uint32_t size;
  uint32_t reserved;
  const c3de_sim_grid
      *grid; /* points are the middles of voxels, in the frame of the mesh as m: before the body's placement */
  const float *values; /* [points], 0 ... 1 */
} c3de_sim_fill;

typedef struct c3de_sim_body {
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh;                    /* of the mesh service; the simulator keeps its own copy of what it needs */
  const c3de_sim_placement *placement; /* null: as the mesh lies */
  const c3de_param_value *params;      /* ids of C3DE_SIM_SCOPE_BODY; what is missing has its default */
  uint64_t params_n;
  const c3de_progress *progress; /* may be null; asked several times a second, also whether anybody still wants it */
  /* Each may be null. Strides are those of the structs as the caller knows them. */
  const c3de_sim_fix *fixes;
  uint64_t fixes_n, fixes_stride;
  const c3de_sim_load *loads;
  uint64_t loads_n, loads_stride;
  const c3de_sim_part *parts;
  uint64_t parts_n, parts_stride;
  const c3de_sim_refinement *refinements;
  uint64_t refinements_n, refinements_stride;
  double velocity_m_s[3];           /* at the start */
  double angular_velocity_rad_s[3]; /* at the start, about the centre of mass */
  const c3de_sim_fill *fill; /* null: the inside of the mesh. Else what the body fills; the mesh is its skin then. The
                              * simulator keeps its own copy. Only where the simulator has displacement(). */
  const float *colour; /* null: the simulator chooses. [3], sRGB, 0 ... 1: the one in which people know the body, that
                        * of its label. Of no effect on the physics. */
} c3de_sim_body;

typedef struct c3de_sim_obstacle { /* rigid; stands still or follows a prescribed motion */
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh;
  const c3de_sim_placement *placement; /* null: as the mesh lies */
  const c3de_param_value *params;      /* ids of C3DE_SIM_SCOPE_OBSTACLE */
  uint64_t params_n;
  const c3de_sim_motion *motion; /* null: stands still; default centre: of its bounds */
} c3de_sim_obstacle;

typedef struct c3de_sim_body_info {
  uint32_t size;
  uint32_t reserved;
  c3de_str name; /* valid until the body is removed */
  uint64_t points, surface_points;
  double mass_kg, volume_m3, mesh_volume_m3, spacing_m, stable_dt_s;
} c3de_sim_body_info;

#define C3DE_SIM_LOAD_STEPS 1u /* a quasi-static solution: steps increase the load, time stays 0 */

typedef struct c3de_sim_status {
  uint32_t size;
  uint32_t failed; /* 1: the last step failed, the state before it is kept */
  uint64_t steps;
  double time_s, dt_s;
  uint64_t bodies, obstacles;
  uint32_t finished; /* 1: nothing changes any more, a step does nothing: a quasi-static solution has reached its full
                      * load. Reset, and a body that is added, make it 0 again. */
  uint32_t stopped;  /* bodies that stand still in their last good state while the others go on; events of the report
                     * say why. step() fails when none is left. */
  uint32_t flags;    /* C3DE_SIM_LOAD_STEPS */
  uint32_t planned_steps; /* to the end; 0: not known */
} c3de_sim_status;

#define C3DE_SIM_ON_POINTS 1u  /* what carries the mass */
#define C3DE_SIM_ON_SURFACE 2u /* what is seen and touched */

/* A quantity that a body has at each of its points, or at each point of its surface. */
typedef struct c3de_sim_field {
  uint32_t size;
  uint32_t on;    /* C3DE_SIM_ON_* */
  c3de_str name;  /* for example C3DE_SIM_FIELD_POSITION; lower case, digits, '_' */
  c3de_str unit;  /* SI, "1" for a ratio */
  uint32_t comps; /* 1; 3: a vector; 9: a matrix, column-major */
  uint32_t reserved;
} c3de_sim_field;

/* Names that mean the same with every simulator; a simulator may have others of its own. */
#define C3DE_SIM_FIELD_REFERENCE_POSITION "reference_position" /* comps 3, m */
#define C3DE_SIM_FIELD_POSITION "position"                     /* comps 3, m */
#define C3DE_SIM_FIELD_VELOCITY "velocity"                     /* comps 3, m/s */
#define C3DE_SIM_FIELD_MASS "mass"     /* comps 1, kg; they add up to the body's, held points included */
#define C3DE_SIM_FIELD_VOLUME "volume" /* comps 1, m^3, at rest */
/* comps 1, Pa: the tension along one direction that distorts as much (equivalent stress) */
#define C3DE_SIM_FIELD_EQUIVALENT_STRESS "stress_vm"

typedef struct c3de_sim_probe {
  uint32_t size;
  uint32_t reserved;
  c3de_str name; /* valid during the call */
  c3de_handle body;
  double reference_m[3], position_m[3], velocity_m_s[3];
} c3de_sim_probe;

#define C3DE_SIM_HOLD_SHAPE 1u /* what is held keeps its shape and turns; else only its weighted mean is led */

/* Springs between a part of a body and a place that somebody moves: a pinch, a clamp. */
typedef struct c3de_sim_hold {
  uint32_t size;
  uint32_t flags;       /* C3DE_SIM_HOLD_*; C3DE_E_UNSUPPORTED for those that a simulator does not serve */
  double at_m[3];       /* what of the body lies in a ball about it, both as the body is now */
  double radius_m;      /* > 0; what is held is at least what a few points of the simulator carry */
  double frequency_hz;  /* of the springs on the mass they hold; 0: the simulator chooses. Lowered where the step would
                        * not carry it: hold_state() says how far the body is off */
  double damping_ratio; /* 1: critical; 0: the simulator chooses */
  double max_force_N;   /* 0: the simulator chooses one that does not tear the body apart */
} c3de_sim_hold;

typedef struct c3de_sim_hold_state {
  uint32_t size;
  uint32_t reserved;
  c3de_handle body;
  double point_m[3];   /* where the point is that was named, as what is held has moved */
  double target_m[3];  /* where it is pulled to */
  double force_N[3];   /* of the last step, on the body */
  double torque_Nm[3]; /* likewise, about the mean of what is held; 0 without C3DE_SIM_HOLD_SHAPE */
  double mass_kg;      /* that is held */
} c3de_sim_hold_state;

/* The points of a body that forces act on, before a step. Arrays lie tight. */
typedef struct c3de_sim_points {
  uint32_t size;
  uint32_t reserved;
  c3de_str name;                /* of the body; may be empty where count is 0 */
  uint64_t count;               /* 0: forces do not move this body, because it is rigid or has stopped */
  const double *positions_m;    /* [count][3] */
  const double *velocities_m_s; /* [count][3] */
  const double *masses_kg;      /* [count], 0 where the body is held */
  double *forces_N;             /* [count][3], zero; what is written acts in the next step */
} c3de_sim_points;

/* Slots that say so may be null: what they are for is then not served, and the host refuses it by name. */
typedef struct c3de_simulator_v1 {
  uint32_t size;
  uint32_t rev;
  /* The host hands over the scene node that stands for this simulation (0: detach); what the simulator shows belongs
   * under it. [main] */
  c3de_status(C3DE_CALL *attach)(c3de_object *self, c3de_handle node);
  /* The parameters of a scope; static. Those of "iface/parameter_ids.h" mean the same with every simulator. [any] */
  c3de_status(C3DE_CALL *declarations)(c3de_object *self, uint32_t scope, const c3de_param_decl **decls, uint64_t *n,
                                       uint64_t *stride);
  /* Checks against the declarations; C3DE_E_ARG or C3DE_E_NOT_FOUND with text, then nothing is changed. [sim] */
  c3de_status(C3DE_CALL *set_world)(c3de_object *self, const c3de_param_value *values, uint64_t n, uint64_t stride);
  /* Builds the body in the calling thread and adds it between two steps; the initial state of the simulation is then
   * the one that has it, at time 0. What it asks for and is not served is refused. An error of one of its fixes, loads,
   * parts or refinements is set with set_error_at() of the host: the field `index` of a fix or load, the place in its
   * array of a part or refinement, from 0. The host then names the line of the scene. [any] */
  c3de_status(C3DE_CALL *add_body)(c3de_object *self, const c3de_sim_body *body, c3de_handle *out);
  c3de_status(C3DE_CALL *add_obstacle)(c3de_object *self, const c3de_sim_obstacle *obstacle, c3de_handle *out);
  /* A material point, given in the body's placed reference shape, reported where it is now. Names differ. [any] */
  c3de_status(C3DE_CALL *add_probe)(c3de_object *self, c3de_str name, c3de_handle body, const double *at_m3,
                                    c3de_handle *out);
  c3de_status(C3DE_CALL *set_body_param)(c3de_object *self, c3de_handle body,
                                         const c3de_param_value *value); /* [sim] */
  c3de_status(C3DE_CALL *get_body_param)(c3de_object *self, c3de_handle body, c3de_str id,
                                         c3de_param_value *out); /* [sim] */
  /* A body, obstacle or probe; a load of add_load(); a hold, which lets go. [sim] */
  c3de_status(C3DE_CALL *remove)(c3de_object *self, c3de_handle what);
  c3de_status(C3DE_CALL *clear)(c3de_object *self); /* [sim] */
  /* One step of the solver's own size. C3DE_E_DIVERGED: the state before it is kept. C3DE_E_TIMEOUT: it has taken
   * longer than the simulator allows, the state before it is kept, and the text says what would help; the host pauses.
   * [sim] */
  c3de_status(C3DE_CALL *step)(c3de_object *self);
  c3de_status(C3DE_CALL *reset)(c3de_object *self);   /* bit for bit the initial state [sim] */
  c3de_status(C3DE_CALL *publish)(c3de_object *self); /* makes the present state the snapshot that is drawn [sim] */
  c3de_status(C3DE_CALL *status)(c3de_object *self, c3de_sim_status *out); /* [sim] */
  /* FNV-1a over all that the next steps follow from, of every body: equal for equal input. [sim] */
  c3de_status(C3DE_CALL *state_hash)(c3de_object *self, uint64_t *out);
  /* JSON object with the keys bodies, probes, reactions, stages, events of the report. [sim] */
  c3de_status(C3DE_CALL *report)(c3de_object *self, c3de_sink json);
  /* Bodies in the order they were added. [sim] */
  c3de_status(C3DE_CALL *body_at)(c3de_object *self, uint64_t index, c3de_handle *out);
  c3de_status(C3DE_CALL *body_info)(c3de_object *self, c3de_handle body, c3de_sim_body_info *out); /* [sim] */
  /* Calls each() for every field of a body, until it returns something other than C3DE_OK, which is returned. Positions
   * and reference positions are always there. [sim] */
  c3de_status(C3DE_CALL *enum_fields)(c3de_object *self, c3de_handle body, void *visitor,
                                      c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_field *field));
  /* Copies a field: comps as it says, f64; room for all rows. C3DE_E_NOT_FOUND for one that the body does not have.
   * [sim] */
  c3de_status(C3DE_CALL *read_field)(c3de_object *self, c3de_handle body, uint32_t on, c3de_str name, c3de_mview out);
  /* The surface as triangles between its points, outwards by the right-hand rule: comps 3, u32, borrowed until the body
   * is removed; no rows where there are none. [sim] */
  c3de_status(C3DE_CALL *triangles)(c3de_object *self, c3de_handle body, c3de_view *out);
  /* Calls each() for every probe in the order they were added, as for fields. [sim] */
  c3de_status(C3DE_CALL *enum_probes)(c3de_object *self, void *visitor,
                                      c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_probe *probe));
  /* May be null: bodies have no `fill` then, and images stay as they were scanned. How far the material that is now at
   * the points of a grid has come, over all bodies: X = x - u(x). Around the bodies u falls to 0 within rim_m >= 0.
   * xyz_m: [points][3], i fastest. gap_m: null, or [points]: how far the material of X is from the point now, where the
   * rim leads back into a body that has gone away; 0 at points of bodies and where X belongs to none, to about a
   * spacing; very large where X lies outside of the grid. [sim] */
  c3de_status(C3DE_CALL *displacement)(c3de_object *self, const c3de_sim_grid *grid, double rim_m, float *xyz_m,
                                       float *gap_m);
  /* May be null: steps run to their end. raised 1: a step that is being computed, and every one that is asked for from
   * now on, answers C3DE_E_CANCELLED within a second or so and leaves the state before it; 0: steps are computed again.
   * Who raises it lowers it. [any] */
  c3de_status(C3DE_CALL *interrupt)(c3de_object *self, uint32_t raised);
  /* May be null. What of the step that is being computed takes long and what would help, for people: one line, empty
   * between steps. Does not wait for the step. [any] */
  c3de_status(C3DE_CALL *activity)(c3de_object *self, c3de_sink text);
  /* May be null: forces of plugins cannot act, and the host says so. The points of a body, for forces from outside in
   * the next step. The arrays are the simulator's and valid until that step begins; a body that is not asked about
   * before a step has no such forces in it. [sim] */
  c3de_status(C3DE_CALL *points)(c3de_object *self, c3de_handle body, c3de_sim_points *out);
  /* May be null: loads come with bodies only. A load more, from the next step on; its ramp begins now. It is there
   * until it is removed, or the simulation reset. [sim] */
  c3de_status(C3DE_CALL *add_load)(c3de_object *self, c3de_handle body, const c3de_sim_load *load, c3de_handle *out);
  /* May be null: nobody can take hold then. From the next step on springs pull a part of the body towards a target,
   * which is where it is until pull() moves it; until the hold is removed, the body is, or the simulation is reset.
   * Several may hold one body. [sim] */
  c3de_status(C3DE_CALL *hold)(c3de_object *self, c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out);
  /* Null as hold. Where the point that was named is pulled to; quaternion4: null, or x, y, z, w of how far what is held
   * is turned since then, of unit length to 1e-6; of no effect without C3DE_SIM_HOLD_SHAPE. [sim] */
  c3de_status(C3DE_CALL *pull)(c3de_object *self, c3de_handle hold, const double *target_m3, const double *quaternion4);
  c3de_status(C3DE_CALL *hold_state)(c3de_object *self, c3de_handle hold,
                                     c3de_sim_hold_state *out); /* null as hold [sim] */
  /* May be null, both or none: states are not kept in files then. All that the next steps follow
   * from, as bytes for load_state() of the same scene; what belongs to nobody's scene, as a hand that holds a body,
   * makes it C3DE_E_STATE with text. The host puts class, version and a checksum before them. [sim] */
  c3de_status(C3DE_CALL *save_state)(c3de_object *self, c3de_sink bytes);
  /* Goes to a state that was saved, with the same bodies, parameters, supports and loads: state_hash()
   * and every step after it are those of then, bit for bit. Bytes of another scene, or malformed ones, are refused with
   * text, and nothing has changed. [sim] */
  c3de_status(C3DE_CALL *load_state)(c3de_object *self, const void *bytes, uint64_t n);
  /* May be null: errors are not verified. How far the bodies, as they are between two steps, are from what this
   * simulator would find with a much finer sampling: solves that beside the simulation, which does not change and may
   * go on. JSON object with the key `bodies`, an object per body in the order they were added: `name`, and either
   * `refused`, a text, or `error_95_m`, `error_max_m`, `error_rms_m` (95 % of the surface, all of it, root of the mean
   * square over the volume) and `largest_displacement_m`; a simulator may add others. progress: may be null; asked
   * several times a second, also whether anybody still wants it: C3DE_E_CANCELLED. [any] */
  c3de_status(C3DE_CALL *verify)(c3de_object *self, const c3de_progress *progress, c3de_sink json);
} c3de_simulator_v1;

#endif
