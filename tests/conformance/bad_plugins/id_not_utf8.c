/* SPDX-License-Identifier: Apache-2.0 */
/* An id that no one can print. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.\xff\xfe"), NO_NEEDS, create_nothing, do_nothing, do_nothing,
                                   destroy_nothing};
ANSWER_WITH(&plugin)
