/* SPDX-License-Identifier: Apache-2.0 */
/* Optional interface of a simulator, beside iface.simulator: supports and loads on a part of the surface of a body, set
 * while it is simulated. They persist over a reset. With iface.changes they are changes of the simulator. SI units. */
#ifndef C3DE_ABI_IFACE_CONDITIONS_H
#define C3DE_ABI_IFACE_CONDITIONS_H

#include "../object.h"

#define C3DE_IFACE_CONDITIONS_ID "draft/c3de.iface.conditions/0"

#define C3DE_SIM_CONDITION_FIX 1u      /* holds the part where it is when the condition is set, or at rest */
#define C3DE_SIM_CONDITION_DISPLACE 2u /* moves it by vector (m) from there, at constant velocity */
#define C3DE_SIM_CONDITION_FORCE 3u    /* vector (N) in total, distributed by area */
#define C3DE_SIM_CONDITION_PRESSURE 4u /* pressure_Pa along the present normal, positive into the body */

#define C3DE_SIM_CONDITION_AT_REST 1u /* of C3DE_SIM_CONDITION_FIX: returns the part to its reference in the ramp */

typedef struct c3de_sim_condition {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_CONDITION_AT_REST */
  uint32_t kind;  /* C3DE_SIM_CONDITION_FIX ... */
  uint32_t reserved;
  c3de_str name; /* for messages and reports */
  c3de_handle body;
  const double *positions_m; /* [positions_n][3], on the surface of the body in its placed reference shape */
  uint64_t positions_n;
  const uint32_t *triangles; /* [triangles_n][3], between the positions, counter-clockwise from outside */
  uint64_t triangles_n;
  double vector[3];
  double pressure_Pa;
  double ramp_s; /* >= 0; simulated time until a value that was set is reached */
} c3de_sim_condition;

typedef struct c3de_sim_condition_state {
  uint32_t size;
  uint32_t reserved;
  double area_m2;    /* in the reference */
  double force_N[3]; /* on the body: the reaction of a support, the resultant of a load */
} c3de_sim_condition_state;

typedef struct c3de_conditions_v0 {
  uint32_t size;
  uint32_t rev;
  /* number: 0, which becomes that of a new condition, or that of an earlier one, which is replaced: from an equal part
   * and kind the value changes continuously during the ramp. C3DE_E_STALE: the body is not there; C3DE_E_ARG: a value
   * is refused, or the part is not on the surface; C3DE_E_STATE: the body cannot move. Nothing changes then. [sim] */
  c3de_status(C3DE_CALL *set)(c3de_object *self, const c3de_sim_condition *condition, uint64_t *number);
  c3de_status(C3DE_CALL *remove)(c3de_object *self, uint64_t number); /* C3DE_E_STALE: there is none [sim] */
  /* warning: why it has no effect, for people; nothing is put where it has one. C3DE_E_STALE: there is none. [sim] */
  c3de_status(C3DE_CALL *state)(c3de_object *self, uint64_t number, c3de_sim_condition_state *out, c3de_sink warning);
} c3de_conditions_v0;

#endif
