/* SPDX-License-Identifier: Apache-2.0 */
/* What a plugin remembers from one run to the next: texts by key, of the person and not of a scene, in a file of the
 * plugin's own in the folder of settings. */
#ifndef C3DE_ABI_SETTINGS_H
#define C3DE_ABI_SETTINGS_H

#include "base.h"

#define C3DE_SETTINGS_ID "c3de.settings/1"

typedef struct c3de_settings_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* The text goes to the sink at once. C3DE_E_NOT_FOUND: nothing was set. Keys: 1 to 200 letters, digits and . _ - /
   * characters. [any] */
  c3de_status(C3DE_CALL *get)(void *ctx, c3de_str key, c3de_sink value);
  /* UTF-8, at most 1 MiB; at most 1000 keys. On disk when this returns. C3DE_E_IO says why it is not; the value holds
   * for this run all the same. [any] */
  c3de_status(C3DE_CALL *set)(void *ctx, c3de_str key, c3de_str value);
  /* C3DE_E_NOT_FOUND: nothing was set; C3DE_E_IO as of set. [any] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_str key);
  /* Calls each() for every key, sorted, until it returns something other than C3DE_OK, which is returned. [any] */
  c3de_status(C3DE_CALL *keys)(void *ctx, void *self, c3de_status(C3DE_CALL *each)(void *self, c3de_str key));
} c3de_settings_v1;

#endif
