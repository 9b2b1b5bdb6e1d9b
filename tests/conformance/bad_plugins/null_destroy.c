/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor without destroy. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.null_destroy"), NO_NEEDS, create_nothing, do_nothing, do_nothing, NULL};
ANSWER_WITH(&plugin)
