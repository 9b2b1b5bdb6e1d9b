/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulator answers beside iface.simulator where it serves pairs of jaws that take hold of tissue. SI units. */
#ifndef C3DE_ABI_IFACE_GRASP_H
#define C3DE_ABI_IFACE_GRASP_H

#include "../object.h"

#define C3DE_IFACE_GRASP_ID "c3de.iface.grasp/1"

/* Where the middle between the jaws is led, and how far they are turned, at a time; between two places all goes on
 * evenly. */
typedef struct c3de_sim_grasp_place {
  uint32_t size;
  uint32_t reserved;
  double time_s; /* ascending */
  double at_m[3];
  double quaternion[4]; /* x, y, z, w: since they took hold, of unit length to 1e-6 */
} c3de_sim_grasp_place;

/* Two jaws that take hold of two patches of the skin of a body, close on the fold between them, and are led. */
typedef struct c3de_sim_grasp {
  uint32_t size;
  uint32_t path_stride;
  c3de_str name;
  c3de_handle body;
  double at_m[3];       /* as a probe's, the body at rest: the jaws stand on either side of the skin nearest to it */
  double axis[3];       /* from the first jaw to the second, of any length; along the skin */
  double jaw_m;         /* > 0, diameter of a patch */
  double opening_m;     /* >= jaw_m, between the middles of the jaws before they close */
  double closed_m;      /* 0 ... opening_m, between the middles of the patches: the jaws stop there */
  double force_limit_N; /* >= 0: nor do they close while they squeeze with more; 0: no limit */
  const c3de_sim_grasp_place *path; /* null: they stay where they took hold */
  uint64_t path_n; /* 0 as null. The jaws take hold at the time of the first place, else at the start */
} c3de_sim_grasp;

typedef struct c3de_grasp_v1 {
  uint32_t size;
  uint32_t rev;
  /* Between two steps; the simulation is reset. It goes with its body; remove() of iface.simulator takes it away. Names
   * differ. C3DE_E_STALE: the body is not there; C3DE_E_ARG: a number is not accepted, or a jaw finds no skin there.
   * [any] */
  c3de_status(C3DE_CALL *add)(c3de_object *self, const c3de_sim_grasp *grasp, c3de_handle *out);
} c3de_grasp_v1;

#endif
