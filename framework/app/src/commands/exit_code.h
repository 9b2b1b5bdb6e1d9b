// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// Exit codes of the program; part of the command line's contract.
enum ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kUsage = 2,
  kInput = 3,
  kPlugin = 4,
  kDiverged = 5,
  kGraphics = 6,
  kOutput = 7,
  kTimeLimit = 124,
  kInterrupted = 130
};

[[nodiscard]] ExitCode exitCodeOf(ErrorCode code);

/// Prints `c3de: error: MESSAGE` to stderr and returns the corresponding exit code.
ExitCode reportError(const Error &error);

}  // namespace c3de::app
