/* SPDX-License-Identifier: Apache-2.0 */
/* Work on several threads: loops inside a step, and long work beside the window. */
#ifndef C3DE_ABI_JOBS_H
#define C3DE_ABI_JOBS_H

#include "base.h"

#define C3DE_JOBS_ID "c3de.jobs/1"

typedef struct c3de_progress {
  uint32_t size;
  uint32_t reserved;
  void *self;
  /* fraction in 0 … 1, negative: unknown. C3DE_E_CANCELLED: stop soon and return that. [any] */
  c3de_status(C3DE_CALL *update)(void *self, double fraction, c3de_str what);
} c3de_progress;

typedef struct c3de_job {
  uint32_t size;
  uint32_t reserved;
  c3de_str title; /* shown beside the progress bar */
  void *self;
  c3de_status(C3DE_CALL *run)(void *self, const c3de_progress *progress); /* [worker] */
  /* Always called once after run, with what it returned (or C3DE_E_CANCELLED if it never ran). [main] */
  void(C3DE_CALL *done)(void *self, c3de_status status, c3de_str error);
} c3de_job;

typedef struct c3de_jobs_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* Calls body for disjoint ranges that cover 0 … n; returns when all are done. Which thread gets which range is not
   * fixed: write only what belongs to the range. Nested calls run inline. [any] */
  void(C3DE_CALL *parallel_for)(void *ctx, uint64_t n, uint64_t grain, void *self,
                                void(C3DE_CALL *body)(void *self, uint64_t begin, uint64_t end));
  uint32_t(C3DE_CALL *thread_count)(void *ctx); /* [any] */
  /* Runs in the background with a progress bar and a cancel button in the window. [main] */
  c3de_status(C3DE_CALL *submit)(void *ctx, const c3de_job *job, c3de_handle *out);
  c3de_status(C3DE_CALL *cancel)(void *ctx, c3de_handle job); /* asks; done() follows [main] */
  /* 0 … 1, negative while unknown; text of the last update goes to the sink. C3DE_E_STALE when finished. [main] */
  c3de_status(C3DE_CALL *progress)(void *ctx, c3de_handle job, double *fraction, c3de_sink what);
} c3de_jobs_v1;

#endif
