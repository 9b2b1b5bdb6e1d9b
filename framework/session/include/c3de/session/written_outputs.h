// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::session {

/// What of a run was written and what was not: a file that fails does not keep the others from being written.
class WrittenOutputs {
 public:
  void add(const std::filesystem::path &file) { written_.push_back(file); }
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
  /// Of what was not written first, and a sentence about all. @pre  not areComplete()
  [[nodiscard]] Error error() const;

 private:
  std::vector<std::filesystem::path> written_, failed_;
  ErrorCode code_ = ErrorCode::output;
};

}  // namespace c3de::session
