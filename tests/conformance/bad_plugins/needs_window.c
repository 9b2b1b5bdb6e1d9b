/* SPDX-License-Identifier: Apache-2.0 */
/* Requires what only a run with a window has; a good plugin there. */
#include "minimal.h"

static const c3de_service_req needs[] = {{sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_PANELS_ID), 1, 0}};
static const c3de_plugin plugin = {NAMED("test.needs_window"), needs, 1, sizeof needs[0], create_nothing, do_nothing,
                                   do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
