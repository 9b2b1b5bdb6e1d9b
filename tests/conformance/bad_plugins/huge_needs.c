/* SPDX-License-Identifier: Apache-2.0 */
/* Says that it needs more services than anybody has; reading them would leave the array. */
#include "minimal.h"

static const c3de_service_req needs[] = {{sizeof(c3de_service_req), C3DE_OPTIONAL, TEXT(C3DE_LOG_ID), 1, 0}};
static const c3de_plugin plugin = {NAMED("test.huge_needs"), needs, UINT64_MAX / 2, sizeof needs[0], create_nothing,
                                   do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
