/* SPDX-License-Identifier: Apache-2.0 */
/* Forces of one's own on the bodies of running simulations, whoever simulates them. Units are SI. */
#ifndef C3DE_ABI_FORCES_H
#define C3DE_ABI_FORCES_H

#include "base.h"

#define C3DE_FORCES_ID "c3de.forces/1"

/* A body as it is before a step. Valid during the call. Arrays lie tight. */
typedef struct c3de_force_call {
  uint32_t size;
  uint32_t reserved;
  c3de_handle simulation; /* scene node of the simulation */
  c3de_handle body;       /* of the simulator; stays the same as long as the body is there */
  c3de_str body_name;
  double time_s; /* simulated; 0 quasi-static */
  uint64_t count;
  const double *positions_m;    /* [count][3], in the frame of the simulation */
  const double *velocities_m_s; /* [count][3] */
  const double *masses_kg;      /* [count], 0 where the body is held */
  double *forces_N;             /* [count][3]: add to it; what other fields have added is in it */
} c3de_force_call;

typedef struct c3de_force_field { /* copied by add, the name included */
  uint32_t size;
  uint32_t reserved;
  c3de_str name; /* for messages */
  void *self;
  /* Before each step, for each body that is neither rigid nor stopped: adds the forces that act on its points in that
   * step. They are constant over the step and gone after it; forces that are not zero wake a body that rests; quasi-static, they grow with the load factor. An error, or
   * a force that is not finite: the field is removed, the step is not made, the simulation pauses, and people are told
   * which plugin and why. [sim] */
  c3de_status(C3DE_CALL *apply)(void *self, const c3de_force_call *call);
} c3de_force_field;

typedef struct c3de_forces_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* From the next step on. simulation: the scene node of one, or 0: all, also those that come later. C3DE_E_ARG;
   * C3DE_E_STATE: called from an apply. [any] */
  c3de_status(C3DE_CALL *add)(void *ctx, c3de_handle simulation, const c3de_force_field *field, c3de_handle *out);
  /* When this returns, apply is not running and will not be called again. C3DE_E_STALE: it has been removed already;
   * C3DE_E_STATE: called from an apply. [any] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle field);
} c3de_forces_v1;

#endif
