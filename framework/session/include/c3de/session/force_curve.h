// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::session {

/// A measured force-displacement curve, in the order of the measurement.
struct ForceCurve {
  std::vector<double> displacement_m, force_N;
  std::vector<int> lines;       ///< of the file, for messages; empty: the curve is of no file
  bool isInMillimetres = true;  ///< the unit that was assumed or stated; false: stated in m
};

/// Maximum number of points in a file.
inline constexpr std::size_t kMaxCurvePoints = 100000;

/// Reads a CSV with the columns `displacement_mm` (or `displacement_m`) and `force_N` in any order; other columns are
/// ignored. Without names, two columns: displacement in mm, force in N. Lines that begin with # are comments. Errors
/// (ErrorCode::input) state file, line, value and what is accepted. Any thread.
[[nodiscard]] Expected<ForceCurve> readForceCurve(const std::filesystem::path &file);

/// What a fit of the stiffness of a body accepts: finite numbers, at least four different values above 0 of what was
/// prescribed, none that decreases, and displacements of a size that is possible. Errors (ErrorCode::input) state point
/// or line.
/// @param isLoaded   the force was prescribed, otherwise the displacement
/// @param extent_m   of the body: diagonal of its box
[[nodiscard]] Expected<void> checkForceCurve(const ForceCurve &curve, bool isLoaded, double extent_m);

}  // namespace c3de::session
