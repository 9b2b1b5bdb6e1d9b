// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace c3de {

/// What calls of code from outside (ForeignCall) have left changed of how a thread rounds and traps, and of the locale: one
/// line for each owner, logged as an error as well. It is restored after the call; a call within no other begins with
/// the rounding and the locale of the program. Any thread.
[[nodiscard]] std::vector<std::string> environmentFaults();

}  // namespace c3de
