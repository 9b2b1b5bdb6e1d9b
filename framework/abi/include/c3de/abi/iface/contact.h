/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulator answers beside iface.simulator where it serves contact of chosen pairs and probe tools. SI units. */
#ifndef C3DE_ABI_IFACE_CONTACT_H
#define C3DE_ABI_IFACE_CONTACT_H

#include "../object.h"

#define C3DE_IFACE_CONTACT_ID "c3de.iface.contact/1"

#define C3DE_SIM_PAIR_HAS_FRICTION 1u /* friction counts; else that of the obstacle, or that of all bodies */
#define C3DE_SIM_PAIR_OFF 2u          /* they pass through each other */
#define C3DE_SIM_PAIR_FITS 4u         /* two bodies: what overlaps of them at the start is no overlap, and stays */

/* Contact of two bodies, or of a body and an obstacle or a probe tool. */
typedef struct c3de_sim_contact_pair {
  uint32_t size;
  uint32_t flags;            /* C3DE_SIM_PAIR_* */
  c3de_handle first, second; /* in any order; 0: the walls of the world */
  double friction;           /* Coulomb, 0 ... 10 */
} c3de_sim_contact_pair;

#define C3DE_SIM_PLACE_HAS_AXIS 1u /* axis counts; else that of the place before */

/* Where a probe tool is at a time; between two places all goes on evenly. */
typedef struct c3de_sim_tool_place {
  uint32_t size;
  uint32_t flags; /* C3DE_SIM_PLACE_* */
  double time_s;  /* ascending. Quasi-static: the load factor takes its place */
  double at_m[3]; /* the middle */
  double axis[3]; /* of a capsule, of any length; that of its first place is (0, 0, 1) where nobody says it */
} c3de_sim_tool_place;

/* A rigid sphere, or a capsule (what is within radius_m of a line), that is led along a path and pushes what it meets.
 * Before the first and after the last place it stands still. */
typedef struct c3de_sim_probe_tool {
  uint32_t size;
  uint32_t path_stride;
  c3de_str name;
  double radius_m; /* > 0 */
  double length_m; /* >= 0, of the line between the middles of the ends; 0: a sphere */
  double friction; /* Coulomb, 0 ... 10 */
  const c3de_sim_tool_place *path;
  uint64_t path_n; /* at least 2 */
} c3de_sim_probe_tool;

typedef struct c3de_sim_probe_tool_state {
  uint32_t size;
  uint32_t points;      /* of contact that press */
  c3de_str name;        /* valid during the call */
  double position_m[3]; /* of the middle */
  double force_N[3];    /* of all bodies on it, mean over the last step */
  double depth_m;       /* >= 0: of the deepest point of a body in it */
} c3de_sim_probe_tool_state;

typedef struct c3de_contact_v1 {
  uint32_t size;
  uint32_t rev;
  /* From the next step on, until it is set again; goes with the body, obstacle or tool. C3DE_E_STALE: one of them is
   * not there; C3DE_E_ARG: neither is a body, or a number is not accepted. [sim] */
  c3de_status(C3DE_CALL *set_pair)(c3de_object *self, const c3de_sim_contact_pair *pair);
  /* May be null, both or none: no probe tools. Adds it between two steps; the simulation is reset. remove() of
   * iface.simulator takes it away. Names differ. [any] */
  c3de_status(C3DE_CALL *add_probe_tool)(c3de_object *self, const c3de_sim_probe_tool *tool, c3de_handle *out);
  /* Calls each() for every tool in the order they were added, until it returns something other than C3DE_OK, which is
   * returned. [sim] */
  c3de_status(C3DE_CALL *enum_probe_tools)(c3de_object *self, void *visitor,
                                           c3de_status(C3DE_CALL *each)(void *visitor,
                                                                        const c3de_sim_probe_tool_state *state));
} c3de_contact_v1;

#endif
