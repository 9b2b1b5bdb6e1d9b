/* SPDX-License-Identifier: Apache-2.0 */
/* The host drives a simulator on a thread of its own; this is how others start, stop and reach it. */
#ifndef C3DE_ABI_SIMULATION_H
#define C3DE_ABI_SIMULATION_H

#include "object.h"

#define C3DE_SIMULATION_ID "c3de.simulation/1"

#define C3DE_SIM_STOPPED 0u /* at the initial state */
#define C3DE_SIM_PLAYING 1u
#define C3DE_SIM_PAUSED 2u
#define C3DE_SIM_FAILED 3u /* the last good state is kept; reset or stop leads out */

#define C3DE_TRANSPORT_PLAY 1u /* also: continue */
#define C3DE_TRANSPORT_PAUSE 2u
#define C3DE_TRANSPORT_STOP 3u  /* ends and goes back to the initial state */
#define C3DE_TRANSPORT_RESET 4u /* to the initial state, bit for bit; goes on playing if it was */
#define C3DE_TRANSPORT_STEP 5u  /* one step, then paused */

typedef struct c3de_sim_transport {
  uint32_t size;
  uint32_t mode; /* C3DE_SIM_* */
  uint64_t steps;
  double time_s;           /* simulated */
  double target_rate;      /* simulated seconds per second that are aimed at; 1 = real time */
  double real_time_factor; /* achieved over the last second of playing, what is being computed
                            * counts as nothing */
  double step_ms;          /* wall time of a step, mean of the last second, or of the present one when that is longer */
  double step_running_s;   /* may be absent (by size). Wall time of the step that is being computed, 0 between steps */
} c3de_sim_transport;

typedef struct c3de_simulation_info { /* borrowed for the call */
  uint32_t size;
  uint32_t reserved;
  c3de_handle node;    /* its scene node */
  c3de_str title;      /* of the scene, for people */
  c3de_object *object; /* answers iface.simulator; retain() keeps it beyond the call */
} c3de_simulation_info;

/* Who is told what becomes of simulations. Null where it does not matter. */
typedef struct c3de_simulation_watch {
  uint32_t size;
  uint32_t reserved;
  void *self;
  void(C3DE_CALL *added)(void *self, c3de_handle node);   /* it can be reached from now on [main] */
  void(C3DE_CALL *removed)(void *self, c3de_handle node); /* it cannot be reached any more [main] */
  /* After every step that was made, before the next one: what iface.simulator says is of the state after it. [sim] */
  void(C3DE_CALL *stepped)(void *self, c3de_handle node, uint64_t steps, double time_s);
} c3de_simulation_watch;

typedef struct c3de_simulation_v1 {
  uint32_t size;
  uint32_t rev; /* 2: from enum_simulations() on */
  void *ctx;
  /* node: the simulation's scene node, as handed to iface.simulator attach(). Takes effect between two steps; pause,
   * stop and reset end the one that is being computed, whose state before it stays. C3DE_E_UNSUPPORTED in a run without
   * a window, which steps by itself to its end. [any] */
  c3de_status(C3DE_CALL *transport)(void *ctx, c3de_handle node, uint32_t action);
  c3de_status(C3DE_CALL *set_target_rate)(void *ctx, c3de_handle node, double rate);   /* 0: as fast as it goes [any] */
  c3de_status(C3DE_CALL *state)(void *ctx, c3de_handle node, c3de_sim_transport *out); /* [any] */
  /* fn(self) runs on the simulation's thread between two steps, soon, also while paused. [any] */
  c3de_status(C3DE_CALL *post)(void *ctx, c3de_handle node, void *self, void(C3DE_CALL *fn)(void *self));
  /* Calls each() for every simulation that there is, until it returns something other than C3DE_OK, which is returned.
   * What the simulator's interface answers [sim] is asked from post() or stepped(). [any] */
  c3de_status(C3DE_CALL *enum_simulations)(void *ctx, void *visitor,
                                           c3de_status(C3DE_CALL *each)(void *visitor,
                                                                        const c3de_simulation_info *info));
  /* added() is called for those that there are, too, before this returns. [main] */
  c3de_status(C3DE_CALL *watch)(void *ctx, const c3de_simulation_watch *watch, c3de_handle *out);
  /* When it returns, none of the functions runs or will be called. C3DE_E_STATE from within stepped(). [main] */
  c3de_status(C3DE_CALL *unwatch)(void *ctx, c3de_handle watch);
} c3de_simulation_v1;

#endif
