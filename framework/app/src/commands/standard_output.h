// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "app.h"

namespace c3de::app {

/// Writes to standard output immediately, so that a failure is detected with its cause. After reserveStandardOutput()
/// it writes to the error stream.
void printOut(std::string_view text);

/// From now on standard output is for a result that was asked for (`--report -`), and what people read is printed to the
/// error stream.
void reserveStandardOutput();
/// Writes that result.
void printResult(std::string_view text);

/// The exit code of the program: that of its command. It is kOutput, with a message, if a successful command could not
/// write its output.
[[nodiscard]] int exitCodeAfterOutput(int ofCommand);

}  // namespace c3de::app
