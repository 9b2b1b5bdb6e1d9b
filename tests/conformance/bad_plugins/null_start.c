/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor without start. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.null_start"), NO_NEEDS, create_nothing, NULL, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
