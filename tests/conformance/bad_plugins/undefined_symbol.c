/* SPDX-License-Identifier: Apache-2.0 */
/* Calls a function of a library that is not there. */
#include "minimal.h"

int a_function_that_nobody_has(void);

static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  return a_function_that_nobody_has();
}

static const c3de_plugin plugin = {NAMED("test.undefined_symbol"), NO_NEEDS, create_nothing, start, do_nothing,
                                   destroy_nothing};
ANSWER_WITH(&plugin)
