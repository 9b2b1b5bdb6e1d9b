// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/session/measurements.h"
#include "c3de/session/preparation.h"
#include "c3de/session/simulator_identity.h"
#include "c3de/session/step_times.h"
#include "c3de/session/tissue_motion.h"

namespace c3de::session {

/// The volume that a skin encloses, by the divergence theorem.
struct SkinVolume {
  double reference_m3 = 0.0, end_m3 = 0.0;
};

/// What the program records about a run; the simulator adds bodies, probes, stages and events.
struct RunFacts {
  std::string scene;  ///< title
  std::string source;
  std::string outcome;  ///< done | diverged | differs (a replay) | failed | interrupted | time_limit
  std::string failure;  ///< the reason, unless the outcome is done
  unsigned threads = 1;
  std::uint64_t steps = 0;
  double time_s = 0.0, wall_s = 0.0, dt_s = 0.0;
  double cpu_s = 0.0;  ///< processor time of all threads during steps
  StepTimes stepTimes;
  /// The simulator's report before the first step; empty: not requested
  std::string startReport;
  std::vector<SkinVolume> skinVolumes;  ///< of the bodies in their order; empty: unknown
  std::vector<TissueMotion> tissues;    ///< of the bodies of many tissues
  Measurements measurements;
  bool isLoadStepped = false;  ///< a quasi-static solution: steps increase the load, there is no time
  SimulatorIdentity simulator;
  std::uint64_t stateHash = 0;
  std::optional<std::uint64_t> seed;
  Prepared prepared;
  std::vector<std::string> accuracy;  ///< accuracyLines() at the end
  std::vector<std::string> notices;   ///< from the simulator, for the user
  std::string verification;           ///< from the simulator, JSON; empty: not requested
  double firstStep_s = 0.0;           ///< the first step alone
  std::string match;                  ///< matchJson(); empty: not a match
  std::string fit;                    ///< fitJson(); empty: not a fit
  /// From the start of the command, including plugins and scene file, to the end of the first step
  double toFirstStep_s = 0.0;
};

/// The report of a run as JSON.
/// @param simulatorJson  report of the simulator; the error (ErrorCode::plugin) states why it is invalid
[[nodiscard]] Expected<std::string> reportJson(const RunFacts &facts, const std::string &simulatorJson);

/// The user-readable lines of a simulator's report ("notices"); empty where it has none.
[[nodiscard]] Expected<std::vector<std::string>> noticesOf(const std::string &simulatorJson);

/// The texts of the report's events of one kind.
[[nodiscard]] std::vector<std::string> eventsOf(const std::string &simulatorJson, const std::string &kind);

}  // namespace c3de::session
