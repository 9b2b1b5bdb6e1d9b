// SPDX-License-Identifier: Apache-2.0
// Texts that assess a sampling and state what would make it good enough.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/placed_mesh.h"
#include "pointbased/simulator.h"

namespace pointbased {

/// Phyxel count of a body at another spacing: V/d³ inside, and the present number per area.
/// @param area  of its surface, m²
[[nodiscard]] double phyxelsAt(const RestState &rest, double area, double spacing);

/// Number of phyxels held by supports, which is largest in rigid tissue. They are part of the count but do not move
/// freely.
[[nodiscard]] std::size_t heldPhyxels(const RestState &rest);

/// Why a lattice is too coarse for the shape it fills, with a spacing and count that suffice. Empty if it is not.
///
/// The thickness is twice the volume over the area: the thickness of a sheet, or the radius of a tube. Below 0.15
/// spacings most cells are almost empty, and pieces of the body hang on single cells. The motion is then that of the
/// lattice rather than of the body. Above that limit the error estimate indicates the quality.
[[nodiscard]] std::string describeCoarseness(const RestState &rest, double area);

/// What reduces an error estimate above 0.1: the count at which it reaches 0.1. Empty if the estimate is no larger.
///
/// For bodies that are held, hang or rest on something, the estimate falls with the spacing to the power
/// kOrderOfEstimate. This applies to e²/(1 - e²), which is error energy over energy, as measured on organs
/// (docs/theory/time.md). For a body thinner than a spacing, the estimate begins to fall at a spacing equal to the
/// thickness.
/// @param estimate  AccuracyStatement::stress of the present state
[[nodiscard]] std::string errorAdvice(const Body &body, double area, double estimate);
inline constexpr double kOrderOfEstimate = 0.7;
inline constexpr double kReportedErrorThreshold = 0.1;

/// Display lines for the end of a run and for the screen: the events and properties of the present state that users
/// need.
[[nodiscard]] std::vector<std::string> noticesOf(const Simulator &simulator, const std::vector<std::string> &errors);

}  // namespace pointbased
