// SPDX-License-Identifier: Apache-2.0
#include "commands/exit_code.h"

#include "c3de/core/log.h"

namespace c3de::app {

ExitCode exitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage: return kUsage;
    case ErrorCode::input: return kInput;
    case ErrorCode::plugin: return kPlugin;
    case ErrorCode::diverged: return kDiverged;
    case ErrorCode::graphics: return kGraphics;
    case ErrorCode::output: return kOutput;
    case ErrorCode::cancelled: return kInterrupted;
    case ErrorCode::state:
    case ErrorCode::internal: return kFailed;
  }
  return kFailed;
}

ExitCode reportError(const Error &error) {
  log(LogLevel::error, error.message);
  return exitCodeOf(error.code);
}

}  // namespace c3de::app
