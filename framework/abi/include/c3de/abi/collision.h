/* SPDX-License-Identifier: Apache-2.0 */
/* Trees of axis-aligned boxes over triangle meshes. Queries are batched; queries on one tree may run on several threads
 * at once; refit and rebuild need that tree to themselves. Lengths are in the unit the positions were given in. */
#ifndef C3DE_ABI_COLLISION_H
#define C3DE_ABI_COLLISION_H

#include "base.h"

#define C3DE_COLLISION_ID "c3de.collision/1"

typedef struct c3de_ray_hit {
  double t;          /* along the direction; < 0: none */
  uint32_t triangle; /* 0xffffffff: none */
  uint32_t reserved;
  double bary[3]; /* weights of the triangle's corners */
} c3de_ray_hit;

typedef struct c3de_closest {
  double point[3];
  double normal[3];  /* unit; angle-weighted pseudonormal of the closest face, edge or vertex */
  double distance;   /* negative inside when the mesh is closed and oriented outwards; +inf: nothing within range */
  uint32_t triangle; /* 0xffffffff: none */
  uint32_t reserved;
  double bary[3];
} c3de_closest;

typedef struct c3de_collision_v1 {
  uint32_t size;
  uint32_t rev; /* 2: has pairs() */
  void *ctx;
  /* positions: comps 3, f32 or f64; triangles: comps 3, u32. Both are copied. [any] */
  c3de_status(C3DE_CALL *create)(void *ctx, c3de_view positions, c3de_view triangles, c3de_handle *out);
  c3de_status(C3DE_CALL *destroy)(void *ctx, c3de_handle tree);                    /* [any], exclusive */
  c3de_status(C3DE_CALL *refit)(void *ctx, c3de_handle tree, c3de_view positions); /* same count [any], exclusive */
  c3de_status(C3DE_CALL *rebuild)(void *ctx, c3de_handle tree);                    /* [any], exclusive */
  /* origins, directions: comps 3, f64, same count; first hit with t in [0, t_max]. [any] */
  c3de_status(C3DE_CALL *rays)(void *ctx, c3de_handle tree, c3de_view origins, c3de_view directions, double t_max,
                               c3de_ray_hit *out);
  /* from, to: comps 3, f64; t in [0, 1]. [any] */
  c3de_status(C3DE_CALL *segments)(void *ctx, c3de_handle tree, c3de_view from, c3de_view to, c3de_ray_hit *out);
  /* Closest point of the surface within max_distance (one per point, or one for all when count is 1). [any] */
  c3de_status(C3DE_CALL *closest)(void *ctx, c3de_handle tree, c3de_view points, c3de_view max_distances,
                                  c3de_closest *out);
  /* Triangles that meet the sphere: up to capacity indices in ascending order; *needed is how many there are.
   * C3DE_S_TRUNCATED if more than capacity. [any] */
  c3de_status(C3DE_CALL *sphere)(void *ctx, c3de_handle tree, const double *centre3, double radius, uint32_t *out,
                                 uint64_t capacity, uint64_t *needed);
  /* From revision 2. Pairs of a triangle of one tree and one of another that are no farther apart than max_distance >= 0
   * (0: they meet): up to capacity pairs of indices, first[0], second[0], first[1], … in ascending order; *needed is how
   * many pairs there are. The same tree twice: each pair once, without those that share a vertex. Both trees are in the
   * same space. C3DE_S_TRUNCATED if more than capacity. [any] */
  c3de_status(C3DE_CALL *pairs)(void *ctx, c3de_handle first, c3de_handle second, double max_distance, uint32_t *out2,
                                uint64_t capacity, uint64_t *needed);
} c3de_collision_v1;

#endif
