// SPDX-License-Identifier: Apache-2.0
// Skins in single precision, one point at a time: its components fill a register of four. Private to the core.
#pragma once

#include <span>

#include "pointbased/surfels.h"

namespace pointbased::kernels {

/// What a range of points reads and writes.
struct SkinJob {
  const CellPlace *places = nullptr;               ///< [points]
  std::span<const std::array<float, 12>> frames;   ///< cof(∂ξ/∂X), columns of four
  const std::array<float, 4> *phyxels = nullptr;   ///< [phyxels] present positions
  const Vec3 *restNormals = nullptr;               ///< [points]; null: positions only
  Vec3f shift{};                                   ///< m, added to every position
  Vec3f *positions = nullptr, *normals = nullptr;  ///< [points]
  // Rows:
  const Index *rowOwners = nullptr, *rowOffsets = nullptr, *rowPhyxels = nullptr;
  const std::array<float, 4> *rowCoefficients = nullptr;
};

/// Points first … last - 1 that lie in cells; the others are left out.
void moveCellPoints(const SkinJob &job, std::size_t first, std::size_t last);
/// Rows first … last - 1, into the places of their points.
void moveRowPoints(const SkinJob &job, std::size_t first, std::size_t last);

}  // namespace pointbased::kernels
