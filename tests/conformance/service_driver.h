/* SPDX-License-Identifier: Apache-2.0 */
/* The interface of the plugin service_driver for the test program. */
#ifndef C3DE_TEST_SERVICE_DRIVER_H
#define C3DE_TEST_SERVICE_DRIVER_H

#include "c3de/abi/object.h"

#define TEST_DRIVER_CLASS "test.Driver/0"
#define TEST_DRIVER_ID "test.iface.driver/0"

typedef struct test_driver_v0 {
  uint32_t size;
  uint32_t rev;
  /* Drives a service ("log", "registry", …) with good and bad arguments. Differences are written to the
   * sink, a line each; returns the number of compared calls. simulation: a node with a simulation behind it. */
  uint64_t(C3DE_CALL *run)(c3de_object *self, c3de_str service, c3de_handle simulation, c3de_sink differences);
} test_driver_v0;

#endif
