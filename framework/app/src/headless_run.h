// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "c3de/abi/draft/iface/simulator.h"
#include "command_run.h"
#include "export_simulation.h"
#include "report.h"

namespace c3de::app {

/// What the scene and the command say about a run's end.
struct RunLimits {
  std::string integrator;
  std::optional<double> loadSteps;  ///< of a quasi-static solution, where the scene says a number; for the progress bar
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::chrono::steady_clock::time_point begin{};  ///< of the command
};

/// Steps a simulator in the calling thread to the end that the options name, samples probes on the way. A quasi-static
/// solution, which has no time, goes on until the simulator says that it is finished, or for as many steps as were asked.
class HeadlessRun {
 public:
  HeadlessRun(Session &session, c3de_object *simulator, const c3de_simulator_v0 *table, const RunOptions &options,
              RunLimits limits)
      : session_(session), simulator_(simulator), table_(table), options_(options), limits_(std::move(limits)) {
    facts_.integrator = limits_.integrator;
  }

  /// Runs; what ended it stands in facts().outcome. The error is about output or about the simulator's report.
  [[nodiscard]] Expected<void> run();
  [[nodiscard]] const RunFacts &facts() const { return facts_; }
  /// The simulator's own report as JSON.
  [[nodiscard]] Expected<std::string> simulatorReport() const;

 private:
  [[nodiscard]] Expected<void> readStatus();
  /// Adds the present state to the export when its time has come, or at any rate.
  [[nodiscard]] Expected<void> exportFrame(bool isEnd);
  [[nodiscard]] bool isDone() const;
  [[nodiscard]] bool isQuasistatic() const { return limits_.integrator == kQuasistatic; }
  [[nodiscard]] double fraction() const;
  [[nodiscard]] std::string position() const;  ///< for messages: how far it has come

  Session &session_;
  c3de_object *simulator_;
  const c3de_simulator_v0 *table_;
  const RunOptions &options_;
  RunLimits limits_;
  RunFacts facts_;
  std::unique_ptr<SimulationExport> export_;
  std::optional<std::uint64_t> exportedStep_;
  double nextFrame_s_ = 0.0;
  bool finished_ = false;
  std::uint32_t stopped_ = 0;
};

}  // namespace c3de::app
