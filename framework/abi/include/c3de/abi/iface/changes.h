/* SPDX-License-Identifier: Apache-2.0 */
/* Optional interface of a simulator, beside iface.simulator: its changes as data. A session re-applies the persistent ones, a
 * replay all of them. */
#ifndef C3DE_ABI_IFACE_CHANGES_H
#define C3DE_ABI_IFACE_CHANGES_H

#include "../object.h"

#define C3DE_IFACE_CHANGES_ID "c3de.iface.changes/1"

#define C3DE_SIM_CHANGE_TRANSIENT \
  1u                              /* a reset removes its effect: a hand, an instrument, a load; others are persistent */
#define C3DE_SIM_CHANGE_RESETS 2u /* applying it also reset the simulation */

/* A change to parameters or state that affects later steps. Adding obstacles, bodies, probes, attachments and grasps through the
 * tables of interfaces is not a change: the caller has their description. Neither are steps, resets and loaded states. */
typedef struct c3de_sim_change {
  uint32_t size;
  uint32_t flags;    /* C3DE_SIM_CHANGE_* */
  c3de_str id;       /* kind of change: lower case, digits, '_', '.' */
  c3de_str key;      /* a later persistent change of equal id and key supersedes this one; empty: never */
  c3de_str text;     /* for people, as in the menu: "set gravity", "add plate" */
  uint64_t steps;    /* completed since the last reset when it was applied */
  const void *bytes; /* its arguments, as the simulator encodes them; objects are named, never by handle */
  uint64_t n;
} c3de_sim_change;

typedef struct c3de_changes_v1 {
  uint32_t size;
  uint32_t rev;
  /* changed() is called for every change from now on, in the order in which they were applied, on the thread that made
   * it; the struct is borrowed for the call, which must not call the simulator. changed null: callbacks have
   * stopped when this returns. One observer at a time. [any] */
  c3de_status(C3DE_CALL *observe)(c3de_object *self, void *observer,
                                  void(C3DE_CALL *changed)(void *observer, const c3de_sim_change *change));
  /* Re-applies a change to a simulator with the same scene and the same changes before. The observer is called as well.
   * C3DE_E_NOT_FOUND: an object that it names is missing; C3DE_E_FORMAT: unknown id or malformed bytes; nothing has
   * changed then. [sim] */
  c3de_status(C3DE_CALL *apply)(c3de_object *self, const c3de_sim_change *change);
} c3de_changes_v1;

#endif
