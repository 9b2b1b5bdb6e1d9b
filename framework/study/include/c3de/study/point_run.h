// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/platform.h"
#include "c3de/study/result.h"

namespace c3de::study {

/// The runs of one point, in a form that can be sent to another process.
struct Task {
  std::string id;                      ///< of the point
  std::vector<std::string> arguments;  ///< program, "run", scene and all settings; without outputs
  unsigned repeat = 1;                 ///< number of runs, one after the other
  double timeLimit_s = 0.0;            ///< of a run
  std::filesystem::path folder;        ///< for intermediate outputs; removed at the end
  std::filesystem::path samples;       ///< points to follow; empty: none
  std::string frequencyOf;             ///< probe whose first frequency is requested; empty: none
  std::size_t component = 0;           ///< of that probe
  bool needsEnergies = false;          ///< whether the energy in play is requested

  [[nodiscard]] std::string text() const;  ///< JSON
  [[nodiscard]] static Expected<Task> fromText(const std::string &text);
};

/// Runs a task in child processes of the program, one after the other, without blocking: call poll() at intervals.
class PointRun {
 public:
  explicit PointRun(Task task);
  /// Nothing while it is running. Errors do not concern the point: ErrorCode::output, a file cannot be written;
  /// ErrorCode::cancelled, the run was interrupted; or the program cannot be started.
  [[nodiscard]] std::optional<Expected<Result>> poll();
  [[nodiscard]] const Task &task() const { return task_; }
  /// Ends the child, with a request before force. The destructor also calls this.
  void cancel();

 private:
  [[nodiscard]] Expected<void> start();
  /// Called for a run that has ended. @return the result of the point, if no more runs remain
  [[nodiscard]] std::optional<Expected<Result>> finish(int exitCode);
  [[nodiscard]] Expected<Result> failed(const std::string &kind, const std::string &reason) const;
  /// Results that the first run provides in addition to its report.
  [[nodiscard]] Expected<void> readFirst();
  /// The last error message of the child.
  [[nodiscard]] std::string lastError() const;

  Task task_;
  unsigned done_ = 0;
  Result result_;  ///< of the runs so far
  std::optional<ChildProcess> child_;
  std::chrono::steady_clock::time_point overdue_{};
};

}  // namespace c3de::study
