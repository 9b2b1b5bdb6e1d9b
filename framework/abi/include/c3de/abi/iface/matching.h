/* SPDX-License-Identifier: Apache-2.0 */
/* Optional interface of a simulator, beside iface.simulator: finds the loads and the rigid motion that bring a body to
 * points measured on its surface. SI units; matrices are row-major. Not for clinical use. */
#ifndef C3DE_ABI_IFACE_MATCHING_H
#define C3DE_ABI_IFACE_MATCHING_H

#include "../jobs.h"
#include "../object.h"

#define C3DE_IFACE_MATCHING_ID "draft/c3de.iface.matching/0"

#define C3DE_MATCH_MOTION_KNOWN 1u /* of a request: the motion is exact and is not changed */
/* of a request: start from the deformation and the forces of the last match of this body, as for the next frame of a
 * sequence; no effect where the body has changed since */
#define C3DE_MATCH_CONTINUE 2u
/* of a request: snapshots and fields have the shape of the latest iteration during the call. Steps, changes, saved
 * states, reports and state hashes use the state before the match. A simulator may ignore it */
#define C3DE_MATCH_SHOW 4u

#define C3DE_MATCH_CONVERGED 1u /* of a result */
#define C3DE_MATCH_ERROR_KNOWN \
  2u /* of a result: the expected errors were computed, because the equilibrium is stable */

/* y = rotation x + translation_m, from the world of the simulation to the space of the measurement. */
typedef struct c3de_match_motion {
  double rotation[9];
  double translation_m[3];
} c3de_match_motion;

typedef struct c3de_match_landmark {
  uint32_t size;
  uint32_t reserved;
  double reference_m[3]; /* in the body at rest */
  double measured_m[3];
  double noise_m; /* standard deviation per axis; 0: that of the points */
} c3de_match_landmark;

typedef struct c3de_match_request {
  uint32_t size;
  uint32_t flags; /* C3DE_MATCH_MOTION_KNOWN, C3DE_MATCH_CONTINUE, C3DE_MATCH_SHOW */
  c3de_handle body;
  const double *points_m; /* [points_n][3] */
  const double *normals;  /* [points_n][3], unit, outwards; null: not known */
  uint64_t points_n;
  const c3de_match_landmark *landmarks;
  uint64_t landmarks_n;
  uint64_t landmarks_stride;
  c3de_match_motion motion; /* from which the match starts */
  double noise_m;           /* > 0: standard deviation of a point across the surface */
  double support_Pa_m;      /* >= 0: of the surroundings of a body without support */
  uint32_t iterations;      /* at most; 0: as many as the simulator uses */
  uint32_t reserved;
} c3de_match_request;

typedef struct c3de_match_result {
  uint32_t size;
  uint32_t flags; /* C3DE_MATCH_CONVERGED, C3DE_MATCH_ERROR_KNOWN */
  uint32_t iterations;
  uint32_t reserved;
  c3de_match_motion motion; /* found */
  c3de_match_motion rigid;  /* the best one without deformation */
  double before_m;  /* root mean square distances of the points to the surface, by robust weights: at the start, */
  double rigid_m;   /* after the rigid motion, */
  double after_m;   /* and of the result */
  double used_part; /* 0 ... 1: of the points; the others are outliers */
  double force_N;   /* sum of the magnitudes of the forces that were found */
  double error_m;   /* expected over the body, root mean square; without errors of the model */
  double largest_error_m;
  double unknown_part; /* 0 ... 1: of the body, about which the measurement says hardly anything */
} c3de_match_result;

typedef struct c3de_matching_v0 {
  uint32_t size;
  uint32_t rev;
  /* The body is then in equilibrium with the forces that were found, which act until a reset. In the world of the
   * simulation it deforms only; the motion is that of the result. progress: may be null; asked several times a second,
   * also whether anybody still wants it. json: object with `points`, an array of objects with `distance_m` and
   * `weight`, and `landmarks`, an array of objects with `error_m`. With
   * C3DE_MATCH_ERROR_KNOWN also `skin_error_m`: the expected error at each point of the surface (C3DE_SIM_ON_SURFACE),
   * null where the measurement says hardly anything; a simulator may leave it out. Nothing changes on an error.
   * C3DE_E_STALE: the body no longer exists; C3DE_E_ARG: a value is refused; C3DE_E_STATE: the body cannot be matched;
   * C3DE_E_CANCELLED. [any] */
  c3de_status(C3DE_CALL *match)(c3de_object *self, const c3de_match_request *request, const c3de_progress *progress,
                                c3de_match_result *out, c3de_sink json);
} c3de_matching_v0;

#endif
