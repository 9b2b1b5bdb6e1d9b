/* SPDX-License-Identifier: Apache-2.0 */
/* Another file with the id of hello. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("org.c3de.hello"), NO_NEEDS, create_nothing, do_nothing, do_nothing,
                                   destroy_nothing};
ANSWER_WITH(&plugin)
