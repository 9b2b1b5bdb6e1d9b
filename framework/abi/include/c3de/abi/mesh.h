/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes. Space is that of the world, millimetres. */
#ifndef C3DE_ABI_MESH_H
#define C3DE_ABI_MESH_H

#include "base.h"
#include "jobs.h"

#define C3DE_MESH_ID "c3de.mesh/1"

#define C3DE_UNIT_UNKNOWN 0u
#define C3DE_UNIT_M 1u
#define C3DE_UNIT_MM 2u
#define C3DE_UNIT_CM 3u

typedef struct c3de_mesh_info {
  uint32_t size;
  uint32_t unit; /* the unit assumed when the file was read */
  uint64_t vertices, triangles, components;
  uint32_t closed, manifold, oriented, repaired; /* 0 or 1 */
  double volume_mm3;                             /* signed; meaningful when closed */
  double min_mm[3], max_mm[3];
} c3de_mesh_info;

typedef struct c3de_mesh_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* Reads, welds and checks a mesh file. The unit is one of C3DE_UNIT_M/MM/CM, or UNKNOWN: what a
   * comment such as UNITS=mm in the file says, else mm. progress may be null. [any] */
  c3de_status(C3DE_CALL *load)(void *ctx, c3de_str path, uint32_t unit, const c3de_progress *progress,
                               c3de_handle *out);
  /* positions: comps 3, f32 or f64, in mm; triangles: comps 3, u32. [any] */
  c3de_status(C3DE_CALL *create)(void *ctx, c3de_view positions_mm, c3de_view triangles, c3de_handle *out);
  c3de_status(C3DE_CALL *release)(void *ctx, c3de_handle mesh);                   /* [any] */
  c3de_status(C3DE_CALL *info)(void *ctx, c3de_handle mesh, c3de_mesh_info *out); /* [any] */
  /* What was found and repaired, several lines of text. [any] */
  c3de_status(C3DE_CALL *report)(void *ctx, c3de_handle mesh, c3de_sink text);
  /* Borrowed until release; f64 in mm, comps 3; u32, comps 3. A mesh never changes. [any] */
  c3de_status(C3DE_CALL *positions)(void *ctx, c3de_handle mesh, c3de_view *out);
  c3de_status(C3DE_CALL *triangles)(void *ctx, c3de_handle mesh, c3de_view *out);
  /* Generalised winding number of each point (comps 3, f64, mm): about 1 inside, 0 outside. out: f64, comps 1. [any] */
  c3de_status(C3DE_CALL *winding_numbers)(void *ctx, c3de_handle mesh, c3de_view points_mm, c3de_mview out);
  /* Whether the mesh bounds a volume that can be filled; C3DE_E_FORMAT says why not and what would help. [any] */
  c3de_status(C3DE_CALL *check_fillable)(void *ctx, c3de_handle mesh);
} c3de_mesh_v1;

#endif
