// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/study/plan.h"

namespace c3de::study {

/// A study that was run before, by another build, on another machine or with other plugins, to be compared with.
struct EarlierRun {
  struct Point {
    double error = 0.0;    ///< as PointOutcome::errors.quantity
    double cost_ms = 0.0;  ///< as Cost::median
  };
  std::string version, date, cpu;            ///< of the program, of the day, of the machine
  std::vector<std::optional<Point>> points;  ///< as in the plan; empty: it failed, or the study did not have it
};

/// Reads `study.json` of the folder of a study. Points are the same if case, label of the grid and values of the levers
/// are; cases that compare another quantity are left out, with a warning.
/// Errors: ErrorCode::input, the file is not there or is none of a study; ErrorCode::usage: no point is in both.
[[nodiscard]] Expected<EarlierRun> loadEarlierRun(const std::filesystem::path &folder, const Study &study,
                                                  const Plan &plan);

}  // namespace c3de::study
