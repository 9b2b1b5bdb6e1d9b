// SPDX-License-Identifier: Apache-2.0
// Display settings; they affect no result.
#pragma once

#include <cstdint>
#include <optional>

namespace pointbased {

enum class SurfaceShown : std::uint8_t { opaque, transparent, hidden };
/// Visible through a surface that is not opaque.
enum class PointsShown : std::uint8_t { evaluationPoints, phyxels, none };
enum class ColourBy : std::uint8_t {
  material,
  displacement,
  vonMises,
  error,
  stabilisation,
  verified,
  contactPressure
};

struct ViewSettings {
  SurfaceShown surface = SurfaceShown::opaque;
  PointsShown points = PointsShown::evaluationPoints;
  ColourBy colourBy = ColourBy::material;
  std::optional<double> range;  ///< value of the last colour, in the unit of the legend; none: automatic

  [[nodiscard]] bool showsPoints() const { return surface != SurfaceShown::opaque && points != PointsShown::none; }
  bool operator==(const ViewSettings &) const = default;
};

}  // namespace pointbased
