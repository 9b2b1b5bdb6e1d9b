/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor with a missing function. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.null_create"), NO_NEEDS, NULL, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
