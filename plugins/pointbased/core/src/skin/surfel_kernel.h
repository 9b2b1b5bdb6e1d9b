// SPDX-License-Identifier: Apache-2.0
// Moves skins in single precision, one point at a time: its components share one register of four. Private to the core.
#pragma once

#include <span>

#include "pointbased/surfels.h"

namespace pointbased::kernels {

/// Input and output for a range of points.
struct SkinJob {
  const CellPoint *cellPoints = nullptr;           ///< [points]
  std::span<const std::array<float, 12>> frames;   ///< cof(∂ξ/∂X), columns of four
  const std::array<float, 4> *phyxels = nullptr;   ///< [phyxels] current positions
  const Vec3 *restNormals = nullptr;               ///< [points]; null: positions only
  Vec3f shift{};                                   ///< m, added to every position
  Vec3f *positions = nullptr, *normals = nullptr;  ///< [points]
  // Rows:
  const Index *rowOwners = nullptr, *rowOffsets = nullptr, *rowPhyxels = nullptr;
  const std::array<float, 4> *rowCoefficients = nullptr;
};

/// Moves points first … last - 1 that are in cells; others are skipped.
void moveCellPoints(const SkinJob &job, std::size_t first, std::size_t last);
/// Moves the points of rows first … last - 1.
void moveRowPoints(const SkinJob &job, std::size_t first, std::size_t last);

}  // namespace pointbased::kernels
