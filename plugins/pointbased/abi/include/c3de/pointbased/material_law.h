/* SPDX-License-Identifier: Apache-2.0 */
/* Material laws that other plugins offer to the point-based plugin: a class whose objects answer this interface, chosen
 * by a scene as material.law = "its class id".
 *
 * A law is isotropic and hyperelastic: an energy density W(F) and its derivatives, pure functions of one point's F and
 * of the parameters. Before a body is made of it, the law is asked about a fixed set of deformations with the body's
 * parameters; one that contradicts itself is refused with the numbers (docs/plugin). Viscosity and volume stiffness of
 * the scene are added by the point-based plugin; plasticity and Prony terms do not combine with such a law.
 *
 * The functions [any] are called from several threads at once for different points, some 64 per call, millions of
 * times: no allocation, no lock, no log. The answer for a point must not depend on the others of its call, to the last
 * bit. An error or a number that is not finite ends the step; the body goes back to its last good state, takes smaller
 * steps, and stops with a message that names the law.
 *
 * Matrices are nine doubles, column-major: F[9 i + 3 c + r] = dx_r / dX_c of point i, in the axes of the simulation. */
#ifndef C3DE_POINTBASED_MATERIAL_LAW_H
#define C3DE_POINTBASED_MATERIAL_LAW_H

#include <c3de/abi/object.h>
#include <c3de/abi/params.h>

#define C3DE_POINTBASED_MATERIAL_LAW_ID "c3de.pointbased.material_law/1"

typedef struct c3de_material_law_v1 {
  uint32_t size;
  uint32_t rev;
  /* The law's parameters: numbers, integers, booleans and choices. A scene says them as material.ID, ID being what is
   * declared here; the point-based plugin checks them. Ids of its own (the user guide's table of a scene's keys) are not accepted, except
   * youngs_modulus (Pa) and poisson_ratio, which a law that lists them takes from the scene's; two laws may share an id
   * only with equal declarations, so begin it with a name. Borrowed from the object, the same for its life. [any] */
  c3de_status(C3DE_CALL *declarations)(c3de_object *self, const c3de_param_decl **decls, uint64_t *n, uint64_t *stride);
  /* In what follows, params has one double for each declaration in its order, within its range: the number, 0 or 1 of a
   * boolean, the place of a choice among its choices. */
  /* W [n], J/m³: 0 at F = I. [any] */
  c3de_status(C3DE_CALL *energy)(c3de_object *self, const double *params, uint64_t n, const double *F, double *W);
  /* P [n][9], Pa: first Piola-Kirchhoff stress dW/dF; 0 at F = I. [any] */
  c3de_status(C3DE_CALL *stress)(c3de_object *self, const double *params, uint64_t n, const double *F, double *P);
  /* dP [n][9], Pa: d/ds P(F + s dF) at s = 0, for dF [n][9]. [any] */
  c3de_status(C3DE_CALL *differential)(c3de_object *self, const double *params, uint64_t n, const double *F,
                                       const double *dF, double *dP);
  /* bounds [n][2], Pa: upper bounds of the fastest wave's modulus, largest a⊗n : dP/dF : a⊗n over unit vectors a and n,
   * and of the largest eigenvalue of dP/dF. The stable explicit step shrinks with their growth against rest. Null: they
   * are derived from nine differentials per point, which costs as much as several stresses. [any] */
  c3de_status(C3DE_CALL *bounds)(c3de_object *self, const double *params, uint64_t n, const double *F, double *bounds);
} c3de_material_law_v1;

#endif
