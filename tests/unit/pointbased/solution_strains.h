// SPDX-License-Identifier: Apache-2.0
// Strains of a solution as used in its energy, to compare two solutions in the energy norm.
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace solution_strains {

using namespace pointbased;

/// ½ E : C : E, J/m³.
[[nodiscard]] double energyOf(const Material &material, const Mat3 &E);

/// Material points (world, m) at which the linear strain of a cell has the energy of the cell, eight per cell.
struct Samples {
  std::vector<Vec3> points;
  std::vector<double> volumes;  ///< m³
};
[[nodiscard]] Samples samplesOf(const RestState &lattice);

/// Green strains at material points (world, m): linear within each cell of a lattice, by its modes; constant around
/// each phyxel of a cloud.
/// @param cells  optional output: the evaluation point of each strain
[[nodiscard]] std::vector<Mat3> strainsAt(const Body &body, std::vector<Vec3> points,
                                          std::vector<std::size_t> *cells = nullptr);

}  // namespace solution_strains
