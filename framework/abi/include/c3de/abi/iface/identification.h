/* SPDX-License-Identifier: Apache-2.0 */
/* Optional interface of a simulator, beside iface.simulator: finds the stiffness of a body from a measured curve, and
 * differentiates its static solutions. SI units. Not for clinical use. */
#ifndef C3DE_ABI_IFACE_IDENTIFICATION_H
#define C3DE_ABI_IFACE_IDENTIFICATION_H

#include "../jobs.h"
#include "../object.h"

#define C3DE_IFACE_IDENTIFICATION_ID "draft/c3de.iface.identification/0"

#define C3DE_FIT_WATCHED 1u /* of a request: watched_m is set */

#define C3DE_FIT_CONVERGED 1u /* of a result */
#define C3DE_FIT_LOADED 2u    /* of a result: a force is prescribed, and the displacement was measured */

#define C3DE_FIT_FOUND 0u        /* verdict: the residuals are those of noise */
#define C3DE_FIT_UNEXPLAINED 1u  /* the model does not have the shape of the curve */
#define C3DE_FIT_UNDETERMINED 2u /* the confidence interval extends beyond half or twice the modulus */

/* A loading curve, in its order. The conditions of the body define what was prescribed: either the displacement of the
 * only support that moves, or the only force. Both quantities are components along it, and its magnitude has no
 * effect. */
typedef struct c3de_fit_request {
  uint32_t size;
  uint32_t flags; /* C3DE_FIT_WATCHED */
  c3de_handle body;
  const double *displacements_m; /* [points_n] */
  const double *forces_N;        /* [points_n] */
  uint64_t points_n;
  double watched_m[3]; /* with a prescribed force: reference position of the point whose displacement was measured */
  double noise;        /* standard deviation of the measurement noise, N or m; 0: not known */
  uint32_t iterations; /* at most; 0: as many as the simulator uses */
  uint32_t reserved;
} c3de_fit_request;

typedef struct c3de_fit_result {
  uint32_t size;
  uint32_t flags; /* C3DE_FIT_CONVERGED, C3DE_FIT_LOADED */
  uint32_t verdict;
  uint32_t iterations;
  uint64_t solutions; /* static ones that were computed */
  double residual;    /* N or m: root mean square per degree of freedom */
  double measured;    /* N or m: root mean square of what was measured */
} c3de_fit_result;

typedef struct c3de_sensitivity_request {
  uint32_t size;
  uint32_t reserved;
  c3de_handle body;
  const double
      *objective;    /* [points_n][3], derivative of the objective with respect to the displacement of each point */
  uint64_t points_n; /* those of iface.simulator's fields of the body */
} c3de_sensitivity_request;

typedef struct c3de_identification_v0 {
  uint32_t size;
  uint32_t rev;
  /* The simulation is unchanged. json: object with `reason` (of a verdict other than FOUND), `moduli`, an array of
   * objects with `material`, `value_Pa`, `low_Pa`, `high_Pa` (95 % confidence interval; null: infinite) and `own`
   * (false: a common factor with others), and `predicted`, an array of numbers (N or m) for the points. C3DE_E_STALE:
   * the body no longer exists; C3DE_E_ARG: a value is refused; C3DE_E_STATE: the body cannot be fitted;
   * C3DE_E_CANCELLED. [any] */
  c3de_status(C3DE_CALL *fit)(c3de_object *self, const c3de_fit_request *request, const c3de_progress *progress,
                              c3de_fit_result *out, c3de_sink json);
  /* Derivatives of an objective at the present static solution, which is unchanged. forces: [points_n][3], with respect
   * to a force on each point. json: object with `supports`, an array of objects with `fix` (number), `displacement`,
   * `rotation` (per rad, about `centre_m`), `foundation` with `stiffness` and `tangential` (per Pa/m), and `moduli`, an
   * array of objects with `material` and `value` (per Pa; null: a custom law). C3DE_E_STATE: no static solution, or one
   * that cannot be differentiated; C3DE_E_CANCELLED. progress may be null. [any] */
  c3de_status(C3DE_CALL *sensitivity)(c3de_object *self, const c3de_sensitivity_request *request,
                                      const c3de_progress *progress, double *forces, c3de_sink json);
} c3de_identification_v0;

#endif
