// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/abi/draft/iface/simulator.h"
#include "command_run.h"
#include "report.h"

namespace c3de::app {

/// Steps a simulator in the calling thread to the end that the options name, samples probes on the way.
class HeadlessRun {
 public:
  HeadlessRun(Session &session, c3de_object *simulator, const c3de_simulator_v0 *table, const RunOptions &options)
      : session_(session), simulator_(simulator), table_(table), options_(options) {}

  /// Runs; what ended it stands in facts().outcome. The error is about output or about the simulator's report.
  [[nodiscard]] Expected<void> run();
  [[nodiscard]] const RunFacts &facts() const { return facts_; }
  /// The simulator's own report as JSON.
  [[nodiscard]] Expected<std::string> simulatorReport() const;

 private:
  [[nodiscard]] Expected<void> readStatus();
  [[nodiscard]] bool isDone() const;
  [[nodiscard]] double fraction() const;

  Session &session_;
  c3de_object *simulator_;
  const c3de_simulator_v0 *table_;
  const RunOptions &options_;
  RunFacts facts_;
};

}  // namespace c3de::app
