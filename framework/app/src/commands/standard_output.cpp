// SPDX-License-Identifier: Apache-2.0
#include "commands/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "commands/exit_code.h"

namespace c3de::app {
namespace {

/// Of the first failure; the process has one standard output.
int &outputError() {
  static int error = 0;
  return error;
}

bool &isReserved() {
  static bool reserved = false;
  return reserved;
}

}  // namespace

void reserveStandardOutput() { isReserved() = true; }

void printOut(std::string_view text) {
  if (!isReserved()) return printResult(text);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void printResult(std::string_view text) {
  if (outputError() != 0) return;
  errno = 0;
  const bool isWritten = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!isWritten) outputError() = errno != 0 ? errno : EIO;
}

int exitCodeAfterOutput(int ofCommand) {
  if (outputError() == 0) return ofCommand;
  const ExitCode failed = reportError(
      {ErrorCode::output, "standard output: could not be written: " + std::generic_category().message(outputError())});
  return ofCommand == kDone ? failed : ofCommand;
}

}  // namespace c3de::app
