/* SPDX-License-Identifier: Apache-2.0 */
#ifndef C3DE_ABI_TIME_H
#define C3DE_ABI_TIME_H

#include "base.h"

#define C3DE_TIME_ID "c3de.time/1"

typedef struct c3de_time_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  uint64_t(C3DE_CALL *now_ns)(void *ctx);      /* monotonic clock [any] */
  uint64_t(C3DE_CALL *frame_index)(void *ctx); /* frames drawn so far [any] */
  void(C3DE_CALL *request_redraw)(void *ctx);  /* wakes the window [any] */
  /* fn(self) runs on the main thread before the next frame. [any] */
  c3de_status(C3DE_CALL *post_to_main)(void *ctx, void *self, void(C3DE_CALL *fn)(void *self));
  /* fn(self) runs on the main thread at the start of every frame, before panels and drawing. [main] */
  c3de_status(C3DE_CALL *add_frame_callback)(void *ctx, void *self, void(C3DE_CALL *fn)(void *self), c3de_handle *out);
  c3de_status(C3DE_CALL *remove_frame_callback)(void *ctx, c3de_handle callback); /* [main] */
} c3de_time_v1;

#endif
