// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "c3de/abi/iface/simulator.h"
#include "c3de/session/change_log.h"
#include "c3de/session/energy_table.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/probe_table.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/recorder.h"
#include "c3de/session/replay.h"
#include "c3de/session/report.h"
#include "c3de/session/run_options.h"
#include "c3de/session/written_outputs.h"

namespace c3de::session {

/// Limits of a run set by the scene and the command.
struct RunLimits {
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::chrono::steady_clock::time_point begin{};  ///< start of the command
};

/// Steps a simulator in the calling thread to the end set by the options, and samples probes on the way. A quasi-static
/// solution, which has no time, continues until the simulator reports that it is finished, or for the requested steps.
class HeadlessRun {
 public:
  /// @param source  of the simulator
  HeadlessRun(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table, const RunOptions &options,
              RunLimits limits, WrittenOutputs &outputs, SimulationSource source = {})
      : session_(session), simulator_(simulator), table_(table), options_(options), limits_(std::move(limits)),
        outputs_(outputs), source_(std::move(source)) {}

  /// Records the run in options.record; call before run().
  void record(std::shared_ptr<Recorder> recorder) { recorder_ = std::move(recorder); }
  /// Repeats a recording to its end, or to options.until_s; call before run(). It must outlive the run.
  void repeat(Replay &replay) { replay_ = &replay; }

  /// Runs the simulation; facts().outcome states how it ended. Probes or an export that cannot be written are reported,
  /// and the run continues without them. The error refers to the simulator's report.
  [[nodiscard]] Expected<void> run();
  [[nodiscard]] const RunFacts &facts() const { return facts_; }
  /// The simulator's own report as JSON.
  [[nodiscard]] Expected<std::string> simulatorReport() const;

 private:
  [[nodiscard]] Expected<void> readStatus();
  /// Opens the outputs requested and writes their first rows; the error refers to the simulator's report.
  [[nodiscard]] Expected<void> beginOutputs();
  [[nodiscard]] Expected<void> stepToEnd(ProgressLine &progress);
  /// Repeats what was recorded before the next step. False: the replay differs from the recording, and the run ends.
  [[nodiscard]] Expected<bool> repeatDue();
  /// Whether a step has changed neither step count nor time, and the run ends as failed.
  [[nodiscard]] bool endsAtStandstill(std::uint64_t stepsBefore, double timeBefore_s);
  void noteRecording();
  /// Makes and times a step; the error states why it could not begin.
  [[nodiscard]] Expected<c3de_status> timedStep(scene::Simulation &simulation, const char *owner, double &step_s);
  void endWith(const char *outcome, std::string failure);
  [[nodiscard]] bool isPastDeadline() const;
  /// Whether an interrupt or the deadline ends the run.
  [[nodiscard]] bool endsByLimit();
  /// Writes a row of the probes; the error refers to the simulator's report.
  [[nodiscard]] Expected<void> sampleProbes();
  /// Writes a row of the energies when due, or unconditionally at the end.
  void sampleEnergies(bool isEnd);
  /// Adds the present state to the export when due, or unconditionally at the end.
  void exportFrame(bool isEnd);
  [[nodiscard]] Expected<void> addFrame();
  void finishOutputs();
  [[nodiscard]] bool isDone() const;
  [[nodiscard]] bool isQuasistatic() const { return facts_.isLoadStepped; }
  [[nodiscard]] double fraction() const;
  [[nodiscard]] std::string position() const;  ///< for messages: the time or load step reached

  Session &session_;
  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  const RunOptions &options_;
  RunLimits limits_;
  RunFacts facts_;
  WrittenOutputs &outputs_;
  SimulationSource source_;
  std::shared_ptr<Recorder> recorder_;  ///< null: not requested, or it has failed
  Replay *replay_ = nullptr;            ///< null: the options state the end
  bool wantsProbes_ = false;            ///< and no write has failed so far
  std::optional<ProbeTable> probes_;
  std::uint64_t sampledStep_ = 0;
  bool wantsEnergies_ = false;  ///< same
  std::optional<EnergyTable> energies_;
  std::optional<std::uint64_t> energyStep_;
  double energyRow_ = -1.0;
  std::unique_ptr<SimulationExport> export_;  ///< same
  std::optional<std::uint64_t> exportedStep_;
  double nextFrame_s_ = 0.0;
  std::uint64_t bodies_ = 0;
  bool finished_ = false;
  std::uint32_t stopped_ = 0;
  std::uint32_t plannedSteps_ = 0;  ///< 0: unknown
};

}  // namespace c3de::session
