/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin without a name. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED(""), NO_NEEDS, create_nothing, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
