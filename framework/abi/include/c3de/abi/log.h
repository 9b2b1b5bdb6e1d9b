/* SPDX-License-Identifier: Apache-2.0 */
#ifndef C3DE_ABI_LOG_H
#define C3DE_ABI_LOG_H

#include "base.h"

#define C3DE_LOG_ID "c3de.log/1"

#define C3DE_LOG_DEBUG 0u
#define C3DE_LOG_INFO 1u
#define C3DE_LOG_WARN 2u
#define C3DE_LOG_ERROR 3u

typedef struct c3de_log_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* One line; the host adds the plugin's id and, from C3DE_LOG_WARN on, shows it to the user. [any] */
  void(C3DE_CALL *write)(void *ctx, uint32_t severity, c3de_str message);
} c3de_log_v1;

#endif
