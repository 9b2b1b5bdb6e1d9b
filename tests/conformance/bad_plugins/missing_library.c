/* SPDX-License-Identifier: Apache-2.0 */
/* Linked against a library that is not there when it is loaded. */
#include "minimal.h"

int in_a_library_that_is_gone(void);

static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  return in_a_library_that_is_gone();
}

static const c3de_plugin plugin = {NAMED("test.missing_library"), NO_NEEDS, create_nothing, start, do_nothing,
                                   destroy_nothing};
ANSWER_WITH(&plugin)
