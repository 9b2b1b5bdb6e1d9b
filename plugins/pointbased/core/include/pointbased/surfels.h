// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pointbased/interpolation.h"

namespace pointbased {

using Vec3f = std::array<float, 3>;

/// A point in a cell of a lattice; occupies one cache line.
struct alignas(64) CellPoint {
  std::array<Index, 8> phyxels{};  ///< corner j at (j & 1, j >> 1 & 1, j >> 2)
  std::array<double, 3> at{};  ///< ξ, 0 … 1 between the corners, outside of that where the functions are extrapolated
  std::uint32_t frame = 0;     ///< of the cell; Surfels::kRow: phyxels[0] is the number of a row
};

/// Compact binding of the points of a skin to phyxels. A row of an Interpolation with the trilinear functions of one
/// undistorted cell is stored as eight phyxels and local coordinates, 64 bytes, from which φ and ∇φ follow up to
/// rounding. Other rows (of clouds, with hanging corners, in jittered cells) are stored unchanged. Const once bound.
class Surfels {
 public:
  Surfels() = default;
  explicit Surfels(const Interpolation &binding);

  [[nodiscard]] std::size_t count() const { return cellPoints_.size(); }
  /// X, m, in the frame of the phyxels.
  [[nodiscard]] Vec3 position(std::size_t p, std::span<const Vec3> phyxelPositions) const;
  /// The original binding: all points, and one.
  [[nodiscard]] Interpolation expanded(std::span<const Vec3> phyxelPositions) const;
  [[nodiscard]] Interpolation expanded(std::size_t p, std::span<const Vec3> phyxelPositions) const;
  /// Number of points stored by local coordinates in a cell.
  [[nodiscard]] std::size_t inCells() const { return cellPoints_.size() - rowOwners_.size(); }
  [[nodiscard]] std::size_t bytes() const;

  static constexpr std::uint32_t kRow = 0xffffffffu;
  // For loops over all points
  [[nodiscard]] std::span<const CellPoint> cellPoints() const { return cellPoints_; }
  [[nodiscard]] std::span<const Mat3> frames() const { return frames_; }  ///< columns ∇ξ_a, 1/m
  /// Cof(∂ξ/∂X), columns
  [[nodiscard]] std::span<const std::array<float, 12>> normalFrames() const { return normalFrames_; }
  [[nodiscard]] const Interpolation &rows() const { return rows_; }
  [[nodiscard]] std::span<const Index> rowOwners() const { return rowOwners_; }  ///< [rows] point
  /// [entries of rows] ∂φ/∂x, ∂φ/∂y, ∂φ/∂z, φ.
  [[nodiscard]] std::span<const std::array<float, 4>> rowCoefficients() const { return rowCoefficients_; }

 private:
  void addFrame(const Mat3 &frame);

  std::vector<CellPoint> cellPoints_;
  std::vector<Mat3> frames_;
  std::vector<std::array<float, 12>> normalFrames_;
  Interpolation rows_;
  std::vector<Index> rowOwners_;
  std::vector<std::array<float, 4>> rowCoefficients_;
};

/// interpolateScalars() of fields.h at the points of a skin.
void interpolateScalars(const Surfels &surfels, std::span<const double> field, std::span<double> out,
                        const ParallelFor &parallelFor);

/// Points and normals of the skin in double precision: x_p, and n_p = cof(F_p) N_p normalised. For exports and new
/// shapes.
/// @param restNormals  [points] N, unit; empty with normals empty
/// @source  Müller et al. 2004, animation of the surface; normals by Nanson's formula
void updateSurfels(const Surfels &surfels, std::span<const Vec3> restNormals, std::span<const Vec3> phyxelPositions,
                   std::span<const Vec3> displacements, std::span<Vec3> positions, std::span<Vec3> normals,
                   const ParallelFor &parallelFor);

/// Present positions of the phyxels in single precision, relative to one of them, so that neither the position of a
/// body in the world nor its travel costs precision. Scratch storage.
struct ScreenPhyxels {
  std::vector<std::array<float, 4>> positions;  ///< [phyxels], the last 0
  Vec3 reference = Vec3::Zero();                ///< frame of the phyxels, m
};

/// Same for display, in single precision: positions to 1e-6 of the body's size, normals to 1e-5 rad times size over
/// spacing / 100, in addition to the rounding of world coordinates. Bitwise identical for any division of the loop and
/// for all instruction sets with fused multiply-add.
/// @param origin     world, m, of the frame of the phyxels
/// @param positions  [points] world, m
/// @param normals    [points] unit, or empty
void updateSurfels(const Surfels &surfels, std::span<const Vec3> restNormals, const Vec3 &origin,
                   std::span<const Vec3> phyxelPositions, std::span<const Vec3> displacements, ScreenPhyxels &scratch,
                   std::span<Vec3f> positions, std::span<Vec3f> normals, const ParallelFor &parallelFor);

}  // namespace pointbased
