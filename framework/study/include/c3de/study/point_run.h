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

/// What is to be run for a point, as it can be sent to another process.
struct Task {
  std::string id;                      ///< of the point
  std::vector<std::string> arguments;  ///< program, "run", scene and all that is set; without outputs
  unsigned repeat = 1;                 ///< runs, one after the other
  double timeLimit_s = 0.0;            ///< of a run
  std::filesystem::path folder;        ///< for its outputs on the way; removed at the end
  std::filesystem::path samples;       ///< points to follow; empty: none
  std::string frequencyOf;             ///< probe whose first frequency is asked for; empty: none
  std::size_t component = 0;           ///< of that probe
  bool wantsEnergies = false;          ///< how much energy is in play

  [[nodiscard]] std::string text() const;  ///< JSON
  [[nodiscard]] static Expected<Task> fromText(const std::string &text);
};

/// Runs a task in child processes of the program, one after the other, without waiting: ask poll() now and then.
class PointRun {
 public:
  explicit PointRun(Task task);
  /// Nothing: it goes on. Errors are not about the point: ErrorCode::output, a file cannot be written; ErrorCode::cancelled,
  /// the run was interrupted; the program cannot be started.
  [[nodiscard]] std::optional<Expected<Result>> poll();
  [[nodiscard]] const Task &task() const { return task_; }
  /// Ends the child, politely first. Also what the destructor does.
  void cancel();

 private:
  [[nodiscard]] Expected<void> start();
  /// Of a run that has ended. @return the result of the point, when there is no more to run
  [[nodiscard]] std::optional<Expected<Result>> finish(int exitCode);
  [[nodiscard]] Expected<Result> failed(const std::string &kind, const std::string &reason) const;
  /// What the first run gives beside its report.
  [[nodiscard]] Expected<void> readFirst();
  /// The last error of the child.
  [[nodiscard]] std::string lastError() const;

  Task task_;
  unsigned done_ = 0;
  Result result_;  ///< of the runs so far
  std::optional<ChildProcess> child_;
  std::chrono::steady_clock::time_point overdue_{};
};

}  // namespace c3de::study
