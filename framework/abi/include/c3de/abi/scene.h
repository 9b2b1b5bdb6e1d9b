/* SPDX-License-Identifier: Apache-2.0 */
/* Scene nodes. World space is LPS, right-handed, millimetres. A simulation works in metres inside its own
 * node; the node's transform (world from node) is the one place where the two meet. */
#ifndef C3DE_ABI_SCENE_H
#define C3DE_ABI_SCENE_H

#include "base.h"

#define C3DE_SCENE_ID "c3de.scene/1"

typedef struct c3de_scene_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* A node under parent (0: the root) that shows up in the scene list. [main] */
  c3de_status(C3DE_CALL *add_node)(void *ctx, c3de_handle parent, c3de_str name, c3de_handle *out);
  c3de_status(C3DE_CALL *remove_node)(void *ctx, c3de_handle node); /* and what is below it [main] */
  /* 16 numbers, column-major: world (mm) from node. [main] */
  c3de_status(C3DE_CALL *world_from_node)(void *ctx, c3de_handle node, double *out16);
  c3de_status(C3DE_CALL *set_visible)(void *ctx, c3de_handle node, uint32_t visible); /* [main] */
  c3de_status(C3DE_CALL *is_visible)(void *ctx, c3de_handle node, uint32_t *visible); /* [main] */
  /* Bounds in the node's own space, used by "fit view". [main] */
  c3de_status(C3DE_CALL *set_bounds)(void *ctx, c3de_handle node, const double *min3, const double *max3);
} c3de_scene_v1;

#endif
