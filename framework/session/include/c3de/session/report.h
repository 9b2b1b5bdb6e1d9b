// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/session/preparation.h"
#include "c3de/session/simulator_identity.h"
#include "c3de/session/step_times.h"
#include "c3de/session/tissue_motion.h"

namespace c3de::session {

/// What a skin encloses, by the divergence theorem.
struct SkinVolume {
  double reference_m3 = 0.0, end_m3 = 0.0;
};

/// What the program knows about a run; the simulator adds bodies, probes, stages and events.
struct RunFacts {
  std::string scene;  ///< title
  std::string source;
  std::string outcome;  ///< done | diverged | failed | interrupted | time_limit
  std::string failure;  ///< why, when it is not done
  unsigned threads = 1;
  std::uint64_t steps = 0;
  double time_s = 0.0, wall_s = 0.0, dt_s = 0.0;
  double cpu_s = 0.0;  ///< processor time of all threads in steps
  StepTimes stepTimes;
  /// The simulator's report before the first step; empty: not asked for
  std::string startReport;
  std::vector<SkinVolume> skinVolumes;  ///< of the bodies in their order; empty: not known
  std::vector<TissueMotion> tissues;    ///< of the bodies of many tissues
  bool isLoadStepped = false;           ///< a quasi-static solution: steps increase the load, there is no time
  SimulatorIdentity simulator;
  std::uint64_t stateHash = 0;
  std::optional<std::uint64_t> seed;
  Prepared prepared;
  std::vector<std::string> accuracy;  ///< accuracyLines() of the end
  std::vector<std::string> notices;   ///< of the simulator, for people
  std::string verification;           ///< of the simulator, JSON; empty: not asked for
  double firstStep_s = 0.0;           ///< the first step alone
  /// From the start of the command, plugins and scene file included, to the end of that step
  double toFirstStep_s = 0.0;
};

/// The report of a run as JSON.
/// @param simulatorJson  what the simulator reported; the error (ErrorCode::plugin) says why it is of no use
[[nodiscard]] Expected<std::string> reportJson(const RunFacts &facts, const std::string &simulatorJson);

/// The lines for people of a simulator's report ("notices"); empty where it has none.
[[nodiscard]] Expected<std::vector<std::string>> noticesOf(const std::string &simulatorJson);

/// The texts of its events of one kind.
[[nodiscard]] std::vector<std::string> eventsOf(const std::string &simulatorJson, const std::string &kind);

}  // namespace c3de::session
