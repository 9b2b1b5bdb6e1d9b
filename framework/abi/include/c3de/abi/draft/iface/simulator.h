/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulator answers. Units are SI throughout: m, kg, s, N, Pa. */
#ifndef C3DE_ABI_DRAFT_IFACE_SIMULATOR_H
#define C3DE_ABI_DRAFT_IFACE_SIMULATOR_H

#include "../../object.h"
#include "../jobs.h"
#include "../params.h"

#define C3DE_IFACE_SIMULATOR_ID "draft/c3de.iface.simulator/0"

#define C3DE_SIM_SCOPE_WORLD 1u    /* gravity, box, solver */
#define C3DE_SIM_SCOPE_BODY 2u     /* material, sampling */
#define C3DE_SIM_SCOPE_OBSTACLE 3u /* friction */

#define C3DE_SIM_REGION_EVERYWHERE 0u
#define C3DE_SIM_REGION_BOX 1u        /* a: min, b: max */
#define C3DE_SIM_REGION_SPHERE 2u     /* a: centre, radius */
#define C3DE_SIM_REGION_HALF_SPACE 3u /* a: point, b: normal; the side the normal points away from */

/* A part of space in material coordinates (the body's placed reference shape), m. */
typedef struct c3de_sim_region {
  uint32_t size;
  uint32_t kind; /* C3DE_SIM_REGION_* */
  double a[3], b[3], radius;
} c3de_sim_region;

#define C3DE_SIM_HAS_CENTRE 1u /* centre_m is given; else the centroid of the part */

/* A rigid motion that is reached at the end of the ramp and kept: rotation about x, then y, then z through the centre,
 * then displacement. Quasi-static: the load factor takes the place of the ramp. */
typedef struct c3de_sim_motion {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_HAS_CENTRE */
  double displacement_m[3], rotation_deg[3], centre_m[3];
  double ramp_s; /* >= 0; 0: at once */
} c3de_sim_motion;

typedef struct c3de_sim_fix { /* the continuum of the region follows the motion */
  uint32_t size;
  uint32_t index; /* its number in reports */
  c3de_str name;  /* may be empty */
  c3de_sim_region region;
  c3de_sim_motion motion;
} c3de_sim_fix;

#define C3DE_SIM_LOAD_PRESSURE 1u /* pressure_Pa counts, else force_N */
#define C3DE_SIM_LOAD_DEAD 2u     /* the pressure keeps its direction and reference area; else it follows the surface */

typedef struct c3de_sim_load {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_LOAD_* */
  uint32_t index; /* its number in messages */
  uint32_t reserved;
  c3de_str name; /* may be empty */
  c3de_sim_region region;
  double force_N[3];  /* total over the region */
  double pressure_Pa; /* pushes into the body */
  double ramp_s;
} c3de_sim_load;

typedef struct c3de_sim_part { /* another material in a region; later ones win */
  uint32_t size;
  uint32_t params_stride;
  c3de_sim_region region;
  const c3de_param_value *params; /* ids "material.…" of C3DE_SIM_SCOPE_BODY; what is missing is as in the body */
  uint64_t params_n;
} c3de_sim_part;

typedef struct c3de_sim_refinement { /* finer sampling in a region */
  uint32_t size;
  uint32_t reserved;
  c3de_sim_region region;
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
  c3de_sim_grid grid; /* points are the middles of voxels, in the frame of the mesh as m: before the body's placement */
  const float *values; /* [points], 0 ... 1 */
} c3de_sim_fill;

typedef struct c3de_sim_body {
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh; /* of the mesh service; the simulator keeps its own copy of what it needs */
  double position_m[3], rotation_deg[3], scale; /* scale, then rotation about x, y, z, then position; scale 0 means 1 */
  const c3de_param_value *params;               /* ids of C3DE_SIM_SCOPE_BODY; what is missing has its default */
  uint64_t params_n;
  const c3de_progress *progress; /* may be null */
  /* What follows may be absent (by size) or null. Strides are those of the structs as the caller knows them. */
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
  const c3de_sim_fill *fill; /* may be absent (by size) or null. What the body fills instead of the inside of the mesh,
                              * which is its skin then. The simulator keeps its own copy. */
  const float *colour; /* may be absent (by size) or null: the simulator chooses. [3], sRGB, 0 ... 1: the one in which
                        * people know the body, that of its label. Of no effect on the physics. */
} c3de_sim_body;

typedef struct c3de_sim_obstacle { /* rigid; stands still or follows a prescribed motion */
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh;
  double position_m[3], rotation_deg[3], scale;
  const c3de_param_value *params; /* ids of C3DE_SIM_SCOPE_OBSTACLE */
  uint64_t params_n;
  const c3de_sim_motion *motion; /* may be absent or null: stands still; default centre: of its bounds */
} c3de_sim_obstacle;

typedef struct c3de_sim_body_info {
  uint32_t size;
  uint32_t reserved;
  c3de_str name; /* valid until the body is removed */
  uint64_t phyxels, surfels;
  double mass_kg, volume_m3, mesh_volume_m3, spacing_m, stable_dt_s;
} c3de_sim_body_info;

typedef struct c3de_sim_status {
  uint32_t size;
  uint32_t failed; /* 1: the last step failed, the state before it is kept */
  uint64_t steps;
  double time_s, dt_s;
  uint64_t bodies, obstacles;
  uint32_t finished; /* may be absent (by size). 1: nothing changes any more, a step does nothing: a quasi-static
                      * solution has reached its full load. Reset, and a body that is added, make it 0 again. */
  uint32_t stopped; /* may be absent. Bodies that stand still in their last good state while the others go on; events of
                     * the report say why. step() fails when none is left. */
} c3de_sim_status;

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

typedef struct c3de_simulator_v0 {
  uint32_t size;
  uint32_t rev; /* 5: has points(). Forces of plugins cannot act in an older one, and the host says so.
                 * 4: has interrupt() and activity(). A step of an older one cannot be ended.
                 * 3: reads `fill` of c3de_sim_body and has displacement().
                 * 2: reads what follows `progress` in c3de_sim_body, obstacles' motion, and answers `finished`. A host
                 * refuses scenes that need it when the simulator is of revision 1, which would ignore it in silence. */
  /* The host hands over the scene node that stands for this simulation (0: detach); what the simulator shows belongs
   * under it. [main] */
  c3de_status(C3DE_CALL *attach)(c3de_object *self, c3de_handle node);
  /* The parameters of a scope; static. [any] */
  c3de_status(C3DE_CALL *declarations)(c3de_object *self, uint32_t scope, const c3de_param_decl **decls, uint64_t *n,
                                       uint64_t *stride);
  /* Checks against the declarations; C3DE_E_ARG or C3DE_E_NOT_FOUND with text, then nothing is changed. [sim] */
  c3de_status(C3DE_CALL *set_world)(c3de_object *self, const c3de_param_value *values, uint64_t n, uint64_t stride);
  /* Builds the body in the calling thread and adds it between two steps; the initial state of the simulation is then
   * the one that has it, at time 0. A message about one of its fixes, loads, parts or refinements begins with "fix N:
   * ", "load N: ", "part N: " or "refinement N: ": the field index of a fix or load, the place in its array of a part
   * or refinement, from 0. The host then names the line of the scene. [any] */
  c3de_status(C3DE_CALL *add_body)(c3de_object *self, const c3de_sim_body *body, c3de_handle *out);
  c3de_status(C3DE_CALL *add_obstacle)(c3de_object *self, const c3de_sim_obstacle *obstacle, c3de_handle *out);
  /* A material point, given in the body's placed reference shape, reported where it is now. [any] */
  c3de_status(C3DE_CALL *add_probe)(c3de_object *self, c3de_str name, c3de_handle body, const double *at_m3);
  c3de_status(C3DE_CALL *set_body_param)(c3de_object *self, c3de_handle body,
                                         const c3de_param_value *value); /* [sim] */
  c3de_status(C3DE_CALL *get_body_param)(c3de_object *self, c3de_handle body, c3de_str id, c3de_param_value *out);
  c3de_status(C3DE_CALL *remove)(c3de_object *self, c3de_handle body_or_obstacle); /* [sim] */
  c3de_status(C3DE_CALL *clear)(c3de_object *self);                                /* [sim] */
  /* One step of the solver's own size. C3DE_E_DIVERGED: the state before it is kept. [sim] */
  c3de_status(C3DE_CALL *step)(c3de_object *self);
  c3de_status(C3DE_CALL *reset)(c3de_object *self);   /* bit for bit the initial state [sim] */
  c3de_status(C3DE_CALL *publish)(c3de_object *self); /* makes the present state the snapshot that is drawn [sim] */
  c3de_status(C3DE_CALL *status)(c3de_object *self, c3de_sim_status *out); /* [sim] */
  /* FNV-1a over positions and velocities of every phyxel. [sim] */
  c3de_status(C3DE_CALL *state_hash)(c3de_object *self, uint64_t *out);
  /* JSON object with the keys bodies, probes, reactions, stages, events of the report. [sim] */
  c3de_status(C3DE_CALL *report)(c3de_object *self, c3de_sink json);
  /* Bodies in the order they were added. [sim] */
  c3de_status(C3DE_CALL *body_at)(c3de_object *self, uint64_t index, c3de_handle *out);
  c3de_status(C3DE_CALL *body_info)(c3de_object *self, c3de_handle body, c3de_sim_body_info *out);
  /* Objects that answer iface.phyxel_set and iface.surfel_set, with a count added for the caller. [sim] */
  c3de_status(C3DE_CALL *phyxels)(c3de_object *self, c3de_handle body, c3de_object **out);
  c3de_status(C3DE_CALL *surfels)(c3de_object *self, c3de_handle body, c3de_object **out);
  /* From revision 3. How far the material that is now at the points of a grid has come, over all bodies:
   * X = x - u(x). Around the bodies u falls to 0 within rim_m >= 0.
   * xyz_m: [points][3], i fastest. gap_m: null, or [points]: how far the material of X is from the point now, where the
   * rim leads back into a body that has gone away; 0 at points of bodies and where X belongs to none, to about a
   * spacing; very large where X lies outside of the grid. [sim] */
  c3de_status(C3DE_CALL *displacement)(c3de_object *self, const c3de_sim_grid *grid, double rim_m, float *xyz_m,
                                       float *gap_m);
  /* From revision 4. raised 1: a step that is being computed, and every one that is asked for from now on, answers
   * C3DE_E_CANCELLED within a second or so and leaves the state before it; 0: steps are computed again. Who raises it
   * lowers it. [any] */
  c3de_status(C3DE_CALL *interrupt)(c3de_object *self, uint32_t raised);
  /* From revision 4. What of the step that is being computed takes long and what would help, for people: one line,
   * empty between steps. Does not wait for the step. [any] */
  c3de_status(C3DE_CALL *activity)(c3de_object *self, c3de_sink text);
  /* From revision 5. The points of a body, for forces from outside in the next step. The arrays are the simulator's and
   * valid until that step begins; a body that is not asked about before a step has no such forces in it. [sim] */
  c3de_status(C3DE_CALL *points)(c3de_object *self, c3de_handle body, c3de_sim_points *out);
} c3de_simulator_v0;

#endif
