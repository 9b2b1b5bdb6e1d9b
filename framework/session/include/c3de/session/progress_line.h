// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace c3de::session {

/// Progress of long work on stderr: a bar that is redrawn on a terminal, otherwise an occasional plain line.
class ProgressLine {
 public:
  /// @param silent  shows nothing
  explicit ProgressLine(bool silent);
  ~ProgressLine() { finish(); }
  ProgressLine(const ProgressLine &) = delete;
  ProgressLine &operator=(const ProgressLine &) = delete;

  /// Cheap when no update is due; may be called at any rate. fraction in 0 … 1.
  void update(double fraction, const std::string &text);
  /// Whether update() would print something, for callers that have to compose the text.
  [[nodiscard]] bool isDue() const;
  /// Terminates the line of the bar.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  bool silent_;
  bool terminal_;
  bool open_ = false;
  std::string shown_;
  Clock::time_point next_{};
};

}  // namespace c3de::session
