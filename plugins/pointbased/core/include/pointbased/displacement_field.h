// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "pointbased/body.h"

namespace pointbased {

/// A regular grid of points in the world.
struct FieldGrid {
  std::array<std::size_t, 3> size{};
  Vec3 origin = Vec3::Zero();     ///< m, of point (0, 0, 0)
  Mat3 steps = Mat3::Identity();  ///< m, columns: from a point to the next along i, j, k; invertible

  [[nodiscard]] std::size_t count() const { return size[0] * size[1] * size[2]; }
};

/// Origin of the material at a position: u(x) with X = x - u(x), on a grid in the world. It is the inverse of the map
/// that carries surfels. Every evaluation point q maps its neighbourhood back,
///
///     X_q(x) = X_q + F_q^-1 (x - x_q),      u(x) = x - Σ w_q X_q(x) / Σ w_q,     w_q = (1 - |X_q(x) - X_q|²/r²)²
///
/// so affine motions are exact on any grid. Positions within a spacing of an evaluation point (r = 1.1 edges of its
/// cell, in the material) belong to the body. Inverted points do not contribute. Material held by supports moves with
/// them exactly.
///
/// Where a body overlaps itself, or two bodies overlap, the points map to material positions that are far apart, and
/// their mean would be meaningless. Only positions within r of each other are averaged. Of several such clusters the
/// one with the largest weight is used, which is the one that is deepest at that position.
class DisplacementField {
 public:
  /// @param withGaps  writeGaps() will be called
  explicit DisplacementField(FieldGrid grid, bool withGaps = false);

  /// Adds a body in its present state. Cost: about 40 grid points per evaluation point if the grid is half as wide as
  /// the spacing; twice that with gaps.
  /// @param points  bindPoints() of its present reference; not used for clouds
  void add(const Body &body, const Interpolation &points);
  /// Writes the sum of what was added, with a falloff around it: from the border of the bodies u decreases smoothly to
  /// 0 within `falloff` (m, >= 0; up to a grid step shorter or longer).
  /// @param out  [points][3] m, i fastest; 0 beyond the falloff
  void write(double falloff, std::span<float> out) const;
  /// Outside of the bodies u leads back to positions that bodies may have left. The gap is the present distance from x
  /// of the material of X = x - u(x): |X + v(X) - x|, with v the displacement of the material, the mean of F_q (X -
  /// X_q) + x_q - X weighted as above. 0 at points of bodies and where X belongs to none; 1000 m where X is outside of
  /// the grid. The decision whether X was inside is accurate to about a spacing only: use the reference shape in
  /// addition if it is available.
  /// @param u    as written by write()
  /// @param out  [points] m
  void writeGaps(std::span<const float> u, std::span<float> out) const;

 private:
  using Sums = std::vector<Eigen::Vector4d>;  // [points] Σ w u, Σ w
  template <class Visit>
  void visitPoints(const Vec3 &centre, const Vec3 &half, const Visit &visit) const;
  void addHeld(const Body &body);
  void addTo(std::size_t p, double w, const Vec3 &u, double reach);
  [[nodiscard]] Eigen::Vector4d heaviest(std::size_t p) const;

  FieldGrid grid_;
  Mat3 toIndex_;
  Sums now_;                                                              // by present positions
  std::unordered_map<std::size_t, std::vector<Eigen::Vector4d>> others_;  // further clusters, where points disagree
  Sums material_;  // by positions in the reference; empty without gaps
};

}  // namespace pointbased
