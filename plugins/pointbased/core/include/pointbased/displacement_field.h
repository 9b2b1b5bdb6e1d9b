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

/// Where the material at a place has come from: u(x) with X = x - u(x), on a grid in the world. It is the inverse of
/// what carries surfels: every evaluation point q maps its surroundings back,
///
///     X_q(x) = X_q + F_q^-1 (x - x_q),      u(x) = x - Σ w_q X_q(x) / Σ w_q,     w_q = (1 - |X_q(x) - X_q|²/r²)²
///
/// so affine motions are exact whatever the grid, and points within a spacing of an evaluation point (r = 1.1 edges of its
/// cell, in the material) belong to the body. Points that are inverted say nothing. What supports hold goes with them
/// exactly.
///
/// Where a body lies over itself, or two bodies over each other, the points lead to places in the material that are far
/// from each other, and a mean of them would be tissue from nowhere. Only those within r of each other are averaged; of
/// several such groups the one with the most weight is shown, which is the one that lies deepest at that place.
class DisplacementField {
 public:
  /// @param withGaps  writeGaps() will be asked for
  explicit DisplacementField(FieldGrid grid, bool withGaps = false);

  /// Adds a body as it is now. Cost: about 40 grid points per evaluation point where the grid is half as wide as the
  /// spacing; twice that with gaps.
  /// @param points  bindPoints() of its present reference; of clouds not looked at
  void add(const Body &body, const Interpolation &points);
  /// What was added, with a rim around it: from the border of the bodies u falls smoothly to 0 within `rim` (m, >= 0;
  /// up to a grid step shorter or longer).
  /// @param out  [points][3] m, i fastest; 0 beyond the rim
  void write(double rim, std::span<float> out) const;
  /// Outside of the bodies u leads back to places from which bodies may have gone away: how far the material of X = x -
  /// u(x) is from x now, |X + v(X) - x| with v the way of the material, the mean of F_q (X - X_q) + x_q - X weighted as
  /// above. 0 at points of bodies and where X belongs to none; 1000 m where X lies outside of the grid. The decision
  /// whether X was inside is coarse, to about a spacing: who knows the reference shape looks there, too.
  /// @param u    as write() left it
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
  Sums now_;                                                              // by present places
  std::unordered_map<std::size_t, std::vector<Eigen::Vector4d>> others_;  // further groups, where points disagree
  Sums material_;  // by places in the reference; empty without gaps
};

}  // namespace pointbased
