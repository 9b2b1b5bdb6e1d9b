// SPDX-License-Identifier: Apache-2.0
// What a sampling is worth, and what would make it good enough, in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "placed_mesh.h"
#include "pointbased/simulator.h"

namespace pointbased {

/// How many phyxels a body has at another spacing: V/d³ inside and as many per area as it has now.
/// @param area  of its surface, m²
[[nodiscard]] double phyxelsAt(const RestState &rest, double area, double spacing);

/// How many phyxels supports hold, in rigid tissue most of all: they are in the count and do not move by themselves.
[[nodiscard]] std::size_t heldPhyxels(const RestState &rest);

/// Why a lattice is too coarse for what it is laid into, with the spacing and count that would do; empty: it is not.
///
/// The thickness is twice the volume over the area: that of a sheet, the radius of a tube. Below 0.15 spacings most
/// cells hold hardly anything, pieces of the body hang on single cells, and what moves is the lattice rather than the
/// body. Above that the error estimate tells how good it is.
[[nodiscard]] std::string tooCoarse(const RestState &rest, double area);

/// What makes an error estimate above 0.1 smaller: the count that brings it there; empty: it is no larger.
///
/// The estimate of bodies that are held, hang or lie falls with the spacing to the power kOrderOfEstimate, in the sense
/// of e²/(1 - e²), which is error energy over energy: measured on organs (docs/theory/time.md). Of a body that is
/// thinner than a spacing it begins to fall at a spacing of the thickness.
/// @param estimate  AccuracyStatement::stress of the present state
[[nodiscard]] std::string errorAdvice(const Body &body, double area, double estimate);
inline constexpr double kOrderOfEstimate = 0.7;
inline constexpr double kErrorToTell = 0.1;

/// Lines for people at the end of a run and on the screen: what of the events and of the present state they should
/// know.
[[nodiscard]] std::vector<std::string> noticesOf(const Simulator &simulator, const std::vector<std::string> &errors);

}  // namespace pointbased
