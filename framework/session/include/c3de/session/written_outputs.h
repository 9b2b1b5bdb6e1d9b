// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::session {

/// Which outputs of a run were written and which failed. The failure of one file does not prevent the others.
class WrittenOutputs {
 public:
  /// --verbose prints its size.
  void add(const std::filesystem::path &file);
  /// Logs the error.
  void addFailure(const std::filesystem::path &file, const Error &error);
  void note(const std::filesystem::path &file, const Expected<void> &result) {
    if (result)
      add(file);
    else
      addFailure(file, result.error());
  }
  [[nodiscard]] bool areComplete() const { return failed_.empty(); }
  /// "a, b"; empty: none.
  [[nodiscard]] std::string written() const;
  /// The first failure, and a sentence about all. @pre  not areComplete()
  [[nodiscard]] Error error() const;

 private:
  std::vector<std::filesystem::path> written_, failed_;
  ErrorCode code_ = ErrorCode::output;
};

}  // namespace c3de::session
