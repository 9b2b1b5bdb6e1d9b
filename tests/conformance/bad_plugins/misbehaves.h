/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of the plugin misbehaves for test_guarded_calls.cpp. */
#ifndef C3DE_TEST_MISBEHAVES_H
#define C3DE_TEST_MISBEHAVES_H

#include "c3de/abi/object.h"

#define TEST_MISBEHAVES_CLASS "test.Misbehaves/0"
#define TEST_MISBEHAVES_ID "test.misbehaves/0"

typedef struct test_misbehaves_v0 {
  uint32_t size;
  uint32_t rev;
  /* Performs the named action; returns the status of the host's function. */
  c3de_status(C3DE_CALL *run)(c3de_object *self, c3de_str what);
} test_misbehaves_v0;

#endif
