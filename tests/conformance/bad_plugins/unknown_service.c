/* SPDX-License-Identifier: Apache-2.0 */
/* Requires a service that no host has, one letter beside one that every host has. */
#include "minimal.h"

static const c3de_service_req needs[] = {{sizeof(c3de_service_req), C3DE_REQUIRED, TEXT("c3de.lag/1"), 1, 0}};
static const c3de_plugin plugin = {NAMED("test.unknown_service"), needs, 1, sizeof needs[0], create_nothing, do_nothing,
                                   do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
