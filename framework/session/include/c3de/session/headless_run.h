// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "c3de/abi/iface/simulator.h"
#include "c3de/session/energy_table.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/probe_table.h"
#include "c3de/session/report.h"
#include "c3de/session/run_options.h"
#include "c3de/session/written_outputs.h"

namespace c3de::session {

/// What the scene and the command say about a run's end.
struct RunLimits {
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::chrono::steady_clock::time_point begin{};  ///< of the command
};

/// Steps a simulator in the calling thread to the end that the options name, samples probes on the way. A quasi-static
/// solution, which has no time, goes on until the simulator says that it is finished, or for as many steps as were
/// asked.
class HeadlessRun {
 public:
  HeadlessRun(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table, const RunOptions &options,
              RunLimits limits, WrittenOutputs &outputs)
      : session_(session), simulator_(simulator), table_(table), options_(options), limits_(std::move(limits)),
        outputs_(outputs) {}

  /// Runs; what ended it stands in facts().outcome. Probes or an export that cannot be written on the way are told, and
  /// the run goes on without them. The error is about the simulator's report.
  [[nodiscard]] Expected<void> run();
  [[nodiscard]] const RunFacts &facts() const { return facts_; }
  /// The simulator's own report as JSON.
  [[nodiscard]] Expected<std::string> simulatorReport() const;

 private:
  [[nodiscard]] Expected<void> readStatus();
  /// A row of the probes; the error is about the simulator's report.
  [[nodiscard]] Expected<void> sampleProbes();
  /// A row of the energies when its time has come, or at any rate.
  void sampleEnergies(bool isEnd);
  /// Adds the present state to the export when its time has come, or at any rate.
  void exportFrame(bool isEnd);
  [[nodiscard]] Expected<void> addFrame();
  void finishOutputs();
  [[nodiscard]] bool isDone() const;
  [[nodiscard]] bool isQuasistatic() const { return facts_.isLoadStepped; }
  [[nodiscard]] double fraction() const;
  [[nodiscard]] std::string position() const;  ///< for messages: how far it has come

  Session &session_;
  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  const RunOptions &options_;
  RunLimits limits_;
  RunFacts facts_;
  WrittenOutputs &outputs_;
  bool wantsProbes_ = false;  ///< and they could be written so far
  std::optional<ProbeTable> probes_;
  std::uint64_t sampledStep_ = 0;
  bool wantsEnergies_ = false;  ///< likewise
  std::optional<EnergyTable> energies_;
  std::optional<std::uint64_t> energyStep_;
  double energyRow_ = -1.0;
  std::unique_ptr<SimulationExport> export_;  ///< likewise
  std::optional<std::uint64_t> exportedStep_;
  double nextFrame_s_ = 0.0;
  bool finished_ = false;
  std::uint32_t stopped_ = 0;
  std::uint32_t plannedSteps_ = 0;  ///< 0: not known
};

}  // namespace c3de::session
