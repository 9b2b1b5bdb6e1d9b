/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulator answers beside iface.simulator where it serves elastic layers that hold bodies. SI units. */
#ifndef C3DE_ABI_IFACE_ATTACHMENT_H
#define C3DE_ABI_IFACE_ATTACHMENT_H

#include "simulator.h"

#define C3DE_IFACE_ATTACHMENT_ID "c3de.iface.attachment/1"

#define C3DE_SIM_ATTACHMENT_WITHIN 1u /* within_m counts; else all of the region, however far they are apart */

/* Springs per area between the surface of a body and what it is attached to, without force in the reference. */
typedef struct c3de_sim_attachment {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_ATTACHMENT_* */
  c3de_str name;
  c3de_handle first;  /* a body */
  c3de_handle second; /* another body or an obstacle; 0: where the surface of the first is in the reference */
  const c3de_sim_region *region; /* of the first; null: everywhere */
  double within_m;               /* > 0: where the two surfaces are that near in the reference */
  double stiffness_Pa_m;         /* >= 0, along the normal */
  double tangential_Pa_m;        /* >= 0, across it */
  double tears_at_Pa;            /* >= 0: points that pull with more are free until the simulation is reset; 0: never */
} c3de_sim_attachment;

typedef struct c3de_sim_attachment_state {
  uint32_t size;
  uint32_t reserved;
  c3de_str name;      /* valid during the call */
  double force_N[3];  /* on the first */
  double torn_part;   /* 0 ... 1, of the area */
  double area_m2;     /* of what was attached at the start */
  double traction_Pa; /* the largest */
} c3de_sim_attachment_state;

typedef struct c3de_attachment_v1 {
  uint32_t size;
  uint32_t rev;
  /* Between two steps; the simulation is reset. It goes with either of what it joins; remove() of iface.simulator takes
   * it away. Names differ. C3DE_E_STALE: a body or obstacle is not there; C3DE_E_ARG: nothing is there to be attached,
   * or a number is not accepted. [any] */
  c3de_status(C3DE_CALL *add)(c3de_object *self, const c3de_sim_attachment *attachment, c3de_handle *out);
  /* Calls each() for every attachment in the order they were added, until it returns something other than C3DE_OK,
   * which is returned. [sim] */
  c3de_status(C3DE_CALL *enumerate)(c3de_object *self, void *visitor,
                                    c3de_status(C3DE_CALL *each)(void *visitor,
                                                                 const c3de_sim_attachment_state *state));
} c3de_attachment_v1;

#endif
