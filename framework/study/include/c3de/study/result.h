// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::study {

/// Result of the runs of a point: the values of their reports that studies compare, and their times. Its text form,
/// which is stored and sent, is JSON.
struct Result {
  std::string id;  ///< of the point
  std::string failure,
      reason;  ///< "crashed", "diverged", "time limit", "failed", "not repeatable"; empty: it succeeded
  std::uint64_t steps = 0;
  double time_s = 0.0, dt_s = 0.0;
  std::string integrator, stateHash;
  struct Body {
    std::string name;
    double spacing_m = 0.0, mass_kg = 0.0, skinAtStart_m3 = 0.0, skinAtEnd_m3 = 0.0;
    std::map<std::string, double> energy_J;
    Vec3 momentum{};
  };
  std::vector<Body> bodies, start;       ///< at the end, and before the first step
  std::map<std::string, Vec3> probes_m;  ///< displacements
  struct Reaction {
    Vec3 force_N{}, torque_Nm{};
  };
  std::map<std::size_t, Reaction> reactions;  ///< by the number of the support
  struct Run {
    double wall_s = 0.0, cpu_s = 0.0, toFirstStep_s = 0.0, stepMedian_ms = 0.0, step99_ms = 0.0, stepMax_ms = 0.0;
  };
  std::vector<Run> runs;
  std::vector<Vec3> positions_m;  ///< of the sample points at the end; empty: none were followed
  std::optional<double> frequency_Hz;
  std::optional<double> peakEnergy_J;  ///< the maximum over time of stored plus kinetic energy, or of the energy
                                       ///< supplied by gravity

  [[nodiscard]] static Result failed(const std::string &id, const std::string &kind, const std::string &reason);
  [[nodiscard]] std::string text() const;
  /// The error (ErrorCode::input) states that it is not a result, or is damaged.
  [[nodiscard]] static Expected<Result> fromText(const std::string &text);
  /// From a report as `c3de run` writes it: one run. `reason` is the failure text of the report, which does not contain
  /// its kind.
  [[nodiscard]] static Expected<Result> fromReport(const std::string &id, const std::string &report);
};

}  // namespace c3de::study
