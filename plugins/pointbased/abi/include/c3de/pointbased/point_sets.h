/* SPDX-License-Identifier: Apache-2.0 */
/* Classes and interfaces that the point-based plugin offers to other plugins beside the simulator's. Phyxels carry the
 * physics of a body, surfels are its visible surface. A set that belongs to a simulator is read between its steps; a
 * set created alone is a cloud of points with the same fields. Units are SI. Functions of a set that belongs to a
 * simulator: [sim]; of one created alone: [any], one call at a time. */
#ifndef C3DE_POINTBASED_POINT_SETS_H
#define C3DE_POINTBASED_POINT_SETS_H

#include <c3de/abi/object.h>

#define C3DE_POINTBASED_PHYXEL_SET_ID "c3de.pointbased.phyxel_set/1"
#define C3DE_POINTBASED_SURFEL_SET_ID "c3de.pointbased.surfel_set/1"
#define C3DE_POINTBASED_BODIES_ID "c3de.pointbased.bodies/1"

/* Classes. */
#define C3DE_POINTBASED_WORLD_SIMULATOR_CLASS "c3de.pointbased.WorldSimulator/1"
#define C3DE_POINTBASED_PHYXEL_CLASS "c3de.pointbased.Phyxel/1"
#define C3DE_POINTBASED_SURFEL_CLASS "c3de.pointbased.Surfel/1"

/* Fields of phyxels. All f64. */
#define C3DE_FIELD_REFERENCE_POSITION 1u /* comps 3, m */
#define C3DE_FIELD_POSITION 2u           /* comps 3, m */
#define C3DE_FIELD_VELOCITY 3u           /* comps 3, m/s */
#define C3DE_FIELD_MASS 4u               /* comps 1, kg */
#define C3DE_FIELD_VOLUME 5u             /* comps 1, m³, at rest */
#define C3DE_FIELD_GRADIENT 6u           /* comps 9, column-major: deformation gradient F */
#define C3DE_FIELD_STRAIN 7u             /* comps 9: Green strain */
#define C3DE_FIELD_STRESS 8u             /* comps 9, Pa: second Piola-Kirchhoff */
/* Fields of surfels beside REFERENCE_POSITION and POSITION. */
#define C3DE_FIELD_NORMAL 9u /* comps 3, unit */

typedef struct c3de_phyxel_set_v1 {
  uint32_t size;
  uint32_t rev;
  uint64_t(C3DE_CALL *count)(c3de_object *self);
  /* Copies a field; out must have room for count rows. */
  c3de_status(C3DE_CALL *read)(c3de_object *self, uint32_t field, c3de_mview out);
  /* CSR neighbour lists of the rest state: offsets (count + 1) and indices, u32, borrowed from the set. */
  c3de_status(C3DE_CALL *neighbours)(c3de_object *self, c3de_view *offsets, c3de_view *indices);
  /* Only for a set created alone: positions (comps 3, f64), rest volumes (comps 1) and a density in kg/m³ make new
   * phyxels with neighbourhoods of `neighbours` points (12 … 100). C3DE_E_STATE for a set of a simulator. */
  c3de_status(C3DE_CALL *assign)(c3de_object *self, c3de_view positions, c3de_view volumes, double density,
                                 uint32_t neighbours);
  /* Only for a set created alone: moves the points; GRADIENT and STRAIN follow. */
  c3de_status(C3DE_CALL *move)(c3de_object *self, c3de_view positions);
} c3de_phyxel_set_v1;

typedef struct c3de_surfel_set_v1 {
  uint32_t size;
  uint32_t rev;
  uint64_t(C3DE_CALL *count)(c3de_object *self);
  c3de_status(C3DE_CALL *read)(c3de_object *self, uint32_t field, c3de_mview out);
  /* CSR: the phyxels that move each surfel and their weights (f64, sum 1), borrowed from the set. */
  c3de_status(C3DE_CALL *owners)(c3de_object *self, c3de_view *offsets, c3de_view *indices, c3de_view *weights);
  /* Only for a set created alone: binds points with normals to a phyxel set. */
  c3de_status(C3DE_CALL *assign)(c3de_object *self, c3de_object *phyxels, c3de_view positions, c3de_view normals);
  /* Revision 2. The skin as triangles between surfels, outwards by the right-hand rule: comps 3, u32, borrowed from the
   * set; no rows where the surfels are points alone. */
  c3de_status(C3DE_CALL *triangles)(c3de_object *self, c3de_view *out);
} c3de_surfel_set_v1;

/* Answered by the simulator of the plugin, beside its iface.simulator, whose handles it takes. */
typedef struct c3de_pointbased_bodies_v1 {
  uint32_t size;
  uint32_t rev;
  /* Objects that answer the set's interface, with a count added for the caller. Stale when the body is removed or built
   * again. [any] */
  c3de_status(C3DE_CALL *phyxels)(c3de_object *self, c3de_handle body, c3de_object **out);
  c3de_status(C3DE_CALL *surfels)(c3de_object *self, c3de_handle body, c3de_object **out);
} c3de_pointbased_bodies_v1;

#endif
