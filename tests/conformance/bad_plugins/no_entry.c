/* SPDX-License-Identifier: Apache-2.0 */
/* A shared library that is no plugin. */
#include "minimal.h"

C3DE_EXPORT int some_other_function(void);
C3DE_EXPORT int some_other_function(void) { return (int)text("a").len; }
