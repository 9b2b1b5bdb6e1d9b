// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/session/measured_points.h"

namespace c3de::session {

/// What was measured at one moment.
struct MeasuredFrame {
  std::string name;              ///< of its file, or the text of its row
  std::optional<double> time_s;  ///< none: not stated
  MeasuredPoints measured;
};

/// Maximum number of frames of a sequence.
inline constexpr std::size_t kMaxFrames = 100000;

/// Reads a sequence: a folder of files that readMeasuredPoints() accepts, in the order of their names (numbers in names
/// by value), or a CSV with the columns `frame` or `time_s`, and `x`, `y`, `z` (and `landmark`),
/// in which each run of rows with the same value is a frame. Errors (ErrorCode::input) state file, line, value and what
/// is accepted; times must increase. Any thread.
[[nodiscard]] Expected<std::vector<MeasuredFrame>> readMeasuredFrames(const std::filesystem::path &path,
                                                                      std::optional<geometry::LengthUnit> unit);

}  // namespace c3de::session
