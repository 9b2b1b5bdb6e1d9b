// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pointbased {

/// Called when a precondition of this library is violated (spans of the wrong size, an invalid index), before any
/// invalid memory access. The default handler reports the violation on stderr and aborts. If a handler returns, abort()
/// follows. A handler that throws, as in tests, leaves everything unchanged.
/// @param condition  source text of the condition
/// @param text       expectation of the function
/// @param function   the called function
/// @threads any at the same time
using PreconditionHandler = void (*)(const char *condition, const char *text, const char *function);

/// @param handler  null: the default
/// @return  the previous handler
/// @threads call before the library is used
PreconditionHandler setPreconditionHandler(PreconditionHandler handler);

}  // namespace pointbased
