// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "app.h"

namespace c3de::app {

/// Writes to standard output, at once, so that a failure is seen and its reason known.
void printOut(std::string_view text);

/// The exit code of the program: that of its command, or kOutput with a message where a command that went well could
/// not say what it had to say.
[[nodiscard]] int exitCodeAfterOutput(int ofCommand);

}  // namespace c3de::app
