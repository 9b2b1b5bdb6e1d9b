/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor that says it ends after its size. */
#include "minimal.h"

static const c3de_plugin plugin = {4, 1, TEXT("test.size_four"), TEXT("1"), TEXT("x"), TEXT(""), TEXT(""),
                                   NO_NEEDS, create_nothing, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
