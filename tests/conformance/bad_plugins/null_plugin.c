/* SPDX-License-Identifier: Apache-2.0 */
/* Agrees and then has no descriptor. */
#include "minimal.h"

ANSWER_WITH(NULL)
