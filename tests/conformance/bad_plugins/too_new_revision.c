/* SPDX-License-Identifier: Apache-2.0 */
/* Requires a later revision of a service than the host has. */
#include "minimal.h"

static const c3de_service_req needs[] = {{sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_COLLISION_ID), 3, 0}};
static const c3de_plugin plugin = {NAMED("test.too_new_revision"), needs, 1, sizeof needs[0], create_nothing, do_nothing,
                                   do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
