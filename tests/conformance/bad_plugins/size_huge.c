/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor whose size is rubbish. */
#include "minimal.h"

static const c3de_plugin plugin = {0x80000000u, 1, TEXT("test.size_huge"), TEXT("1"), TEXT("x"), TEXT(""), TEXT(""),
                                   NO_NEEDS, create_nothing, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
