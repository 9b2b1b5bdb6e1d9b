/* SPDX-License-Identifier: Apache-2.0 */
/* Retained drawing: create a proxy once, update its arrays when they change. Absent when there is no window. */
#ifndef C3DE_ABI_RENDER_H
#define C3DE_ABI_RENDER_H

#include "base.h"

#define C3DE_RENDER_ID "c3de.render/1"

#define C3DE_ATTR_POSITIONS 1u /* comps 3, f32 or f64, node space */
#define C3DE_ATTR_NORMALS 2u   /* comps 3; absent on a mesh: computed from the triangles at each update */
/* comps 3 or 4, f32 in 0 … 1, or u8; since revision 2, count 0: back to the material's */
#define C3DE_ATTR_COLOURS 3u
#define C3DE_ATTR_RADII 4u /* spheres: comps 1, node space */

typedef struct c3de_material {
  uint32_t size;
  uint32_t two_sided;
  float colour[4]; /* sRGB and opacity, 0 … 1; opacity below 1 blends, correctly ordered */
  /* May be absent (by size). 1: drawn over the slices of an image, too: lines and labels as the slice sees them,
   * fainter off its plane; spheres as the circle in which it cuts them. Meshes are outlined there anyway. In the 3D
   * view lines and spheres of it are whole and before everything else. */
  uint32_t in_slices;
} c3de_material;

/* What colours mean: a bar with numbers at the right edge of the picture, the next one below it. */
typedef struct c3de_legend {
  uint32_t size;
  uint32_t reserved;
  c3de_str title;    /* for example "Displacement" */
  c3de_str unit;     /* for example "mm"; empty: none */
  c3de_str note;     /* lines below the bar; empty: none */
  double low, high;  /* values of the first and the last colour, finite, low < high */
  c3de_view colours; /* comps 3 or 4, f32 in 0 … 1, or u8; 2 to 1024 at even distances, the one of `low` first */
} c3de_legend;

/* Revision 2: create_legend, set_legend. */
typedef struct c3de_render_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* Proxies live under a scene node: its transform and visibility apply. Triangles: comps 3, u32. [main] */
  c3de_status(C3DE_CALL *create_mesh)(void *ctx, c3de_handle node, c3de_view positions, c3de_view triangles,
                                      const c3de_material *material, c3de_handle *out);
  c3de_status(C3DE_CALL *create_spheres)(void *ctx, c3de_handle node, c3de_view centres, double radius,
                                         const c3de_material *material, c3de_handle *out);
  /* Pairs of points. width in pixels. [main] */
  c3de_status(C3DE_CALL *create_lines)(void *ctx, c3de_handle node, c3de_view points, float width_px,
                                       const c3de_material *material, c3de_handle *out);
  /* Text at a point of the node's space. [main] */
  c3de_status(C3DE_CALL *create_label)(void *ctx, c3de_handle node, const double *at3, c3de_str text,
                                       const c3de_material *material, c3de_handle *out);
  /* Replaces an array of the proxy; the count may change for spheres and lines, not for meshes. [main] */
  c3de_status(C3DE_CALL *update)(void *ctx, c3de_handle proxy, uint32_t attribute, c3de_view values);
  c3de_status(C3DE_CALL *set_label)(void *ctx, c3de_handle proxy, const double *at3, c3de_str text); /* [main] */
  c3de_status(C3DE_CALL *set_material)(void *ctx, c3de_handle proxy, const c3de_material *material); /* [main] */
  c3de_status(C3DE_CALL *set_visible)(void *ctx, c3de_handle proxy, uint32_t visible);               /* [main] */
  c3de_status(C3DE_CALL *destroy)(void *ctx, c3de_handle proxy);                                     /* [main] */
  /* Since revision 2. Shown while the node is visible, in pictures as well. [main] */
  c3de_status(C3DE_CALL *create_legend)(void *ctx, c3de_handle node, const c3de_legend *legend, c3de_handle *out);
  c3de_status(C3DE_CALL *set_legend)(void *ctx, c3de_handle proxy, const c3de_legend *legend); /* likewise [main] */
} c3de_render_v1;

#endif
