// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pointbased {

/// Called where a caller breaks a precondition of this library (spans of the wrong size, an index that is none): what
/// follows would read what is not there. The default says which, on stderr, and aborts. One that returns is followed
/// by abort(); one that throws, as tests do, leaves nothing changed.
/// @param condition  as it stands in the source
/// @param text       what the function expects
/// @param function   that was called
/// @threads any at the same time
using PreconditionHandler = void (*)(const char *condition, const char *text, const char *function);

/// @param handler  null: the default
/// @return the one of before
/// @threads before the library is used
PreconditionHandler setPreconditionHandler(PreconditionHandler handler);

}  // namespace pointbased
