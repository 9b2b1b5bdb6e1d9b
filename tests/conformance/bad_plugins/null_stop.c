/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor without stop. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.null_stop"), NO_NEEDS, create_nothing, do_nothing, NULL, destroy_nothing};
ANSWER_WITH(&plugin)
