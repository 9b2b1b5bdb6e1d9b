// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/study/plan.h"

namespace c3de::study {

/// An earlier run of a study, by another build, on another machine or with other plugins, for comparison.
struct EarlierRun {
  struct Point {
    double error = 0.0;    ///< same as PointOutcome::errors.quantity
    double cost_ms = 0.0;  ///< same as Cost::median
  };
  std::string version, date, cpu;            ///< of the program; day of the run; of the machine
  std::vector<std::optional<Point>> points;  ///< as in the plan; empty: it failed, or the earlier study did not contain
                                             ///< it
};

/// Reads `study.json` of a study's folder. Points are the same if case, label of the grid and values of the study
/// parameters are equal. Cases that compare another quantity are omitted, with a warning.
/// Errors: ErrorCode::input: the file does not exist or is not that of a study; ErrorCode::usage: no point is in both.
[[nodiscard]] Expected<EarlierRun> loadEarlierRun(const std::filesystem::path &folder, const Study &study,
                                                  const Plan &plan);

}  // namespace c3de::study
