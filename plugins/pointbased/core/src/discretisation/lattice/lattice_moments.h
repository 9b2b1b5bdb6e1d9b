// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/cut_cell_fragments.h"

namespace pointbased::lattice {

/// Moments of material about the centre of its cell, in edges of the cell: all data for the means of trilinear
/// functions and of their gradients.
struct Moments {
  double share = 0.0;  ///< of the cell
  Vec3 first = Vec3::Zero();
  Vec3 mixed = Vec3::Zero();    ///< xy, xz, yz
  double triple = 0.0;          ///< xyz
  Vec3 second = Vec3::Zero();   ///< xx, yy, zz
  Mat3 cubic = Mat3::Zero();    ///< aab in row a, column b; the diagonal is not used
  Vec3 quartic = Vec3::Zero();  ///< xxyz, yyxz, zzxy

  void add(double part, const Vec3 &centre, const Vec3 &variance);
  [[nodiscard]] Vec3 centroid() const { return first / share; }
  /// Variance along the axes, edges².
  [[nodiscard]] Vec3 variance() const;
  /// Means of N_j.
  [[nodiscard]] std::array<double, 8> functions() const;
  /// Means of ∇N_j, 1/edge.
  [[nodiscard]] std::array<Vec3, 8> gradients() const;
};
[[nodiscard]] Moments fullCell();

/// N_j and ∇N_j (1/edge) at a position in edges from the centre of the cell.
[[nodiscard]] std::array<double, 8> trilinear(const Vec3 &place);
[[nodiscard]] std::array<Vec3, 8> trilinearGradients(const Vec3 &place);

/// Part of the small cell around a sample that is inside.
struct SampleContent {
  double share = 0.0;            ///< of the small cell
  Vec3 centre = Vec3::Zero();    ///< of that part, in edges of the cell from its centre
  Vec3 variance = Vec3::Zero();  ///< edges²
  Vec3 normal = Vec3::Zero();    ///< of the surface that cuts the small cell, outwards, or zero
};
/// For a planar surface across the small cell: its distance is known, its direction follows from the adjacent samples.
[[nodiscard]] SampleContent contentOf(const CellSet &set, const Cell &cell, int sample);

/// Factors of the modes xy, xz, yz of a part of a cut cell: sqrt(max(0.02, 1 - 5 n_i² n_j²)), n the mean normal of the
/// surface in it. A mode across a slanted surface is not the one that a free surface would have.
[[nodiscard]] Eigen::Vector4d modeFactors(const CellSet &set, const CutCellFragment &part);

/// Moments of the whole part.
[[nodiscard]] Moments momentsOf(const CellSet &set, const CutCellFragment &part);

}  // namespace pointbased::lattice
