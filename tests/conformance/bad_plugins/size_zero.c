/* SPDX-License-Identifier: Apache-2.0 */
/* A descriptor that was never filled in. */
#include "minimal.h"

static const c3de_plugin plugin = {0};
ANSWER_WITH(&plugin)
