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

typedef struct c3de_sim_body {
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh; /* of the mesh service; the simulator keeps its own copy of what it needs */
  double position_m[3], rotation_deg[3], scale; /* scale, then rotation about x, y, z, then position; scale 0 means 1 */
  const c3de_param_value *params; /* ids of C3DE_SIM_SCOPE_BODY; what is missing has its default */
  uint64_t params_n;
  const c3de_progress *progress; /* may be null */
} c3de_sim_body;

typedef struct c3de_sim_obstacle { /* stands still */
  uint32_t size;
  uint32_t params_stride;
  c3de_str name;
  c3de_handle mesh;
  double position_m[3], rotation_deg[3], scale;
  const c3de_param_value *params; /* ids of C3DE_SIM_SCOPE_OBSTACLE */
  uint64_t params_n;
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
} c3de_sim_status;

typedef struct c3de_simulator_v0 {
  uint32_t size;
  uint32_t rev;
  /* The host hands over the scene node that stands for this simulation (0: detach); what the simulator shows belongs
   * under it. [main] */
  c3de_status(C3DE_CALL *attach)(c3de_object *self, c3de_handle node);
  /* The parameters of a scope; static. [any] */
  c3de_status(C3DE_CALL *declarations)(c3de_object *self, uint32_t scope, const c3de_param_decl **decls, uint64_t *n,
                                       uint64_t *stride);
  /* Checks against the declarations; C3DE_E_ARG or C3DE_E_NOT_FOUND with text, then nothing is changed. [sim] */
  c3de_status(C3DE_CALL *set_world)(c3de_object *self, const c3de_param_value *values, uint64_t n, uint64_t stride);
  /* Builds the body in the calling thread and adds it between two steps; the initial state of the simulation is then
   * the one that has it, at time 0. [any] */
  c3de_status(C3DE_CALL *add_body)(c3de_object *self, const c3de_sim_body *body, c3de_handle *out);
  c3de_status(C3DE_CALL *add_obstacle)(c3de_object *self, const c3de_sim_obstacle *obstacle, c3de_handle *out);
  /* A material point, given in the body's placed reference shape, reported where it is now. [any] */
  c3de_status(C3DE_CALL *add_probe)(c3de_object *self, c3de_str name, c3de_handle body, const double *at_m3);
  c3de_status(C3DE_CALL *set_body_param)(c3de_object *self, c3de_handle body, const c3de_param_value *value); /* [sim] */
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
  /* JSON object with the keys bodies, probes, stages, events of the report. [sim] */
  c3de_status(C3DE_CALL *report)(c3de_object *self, c3de_sink json);
  /* Bodies in the order they were added. [sim] */
  c3de_status(C3DE_CALL *body_at)(c3de_object *self, uint64_t index, c3de_handle *out);
  c3de_status(C3DE_CALL *body_info)(c3de_object *self, c3de_handle body, c3de_sim_body_info *out);
  /* Objects that answer iface.phyxel_set and iface.surfel_set, with a count added for the caller. [sim] */
  c3de_status(C3DE_CALL *phyxels)(c3de_object *self, c3de_handle body, c3de_object **out);
  c3de_status(C3DE_CALL *surfels)(c3de_object *self, c3de_handle body, c3de_object **out);
} c3de_simulator_v0;

#endif
