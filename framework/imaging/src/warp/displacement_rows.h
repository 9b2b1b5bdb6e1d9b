// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/imaging/displacement.h"
#include "trilinear.h"

namespace c3de::imaging {

/// Indices this far outside a grid count as on its border: a conversion through two matrices is accurate to about
/// 1e-13.
constexpr double kOnBorder = 1e-6;

/// Displacements along one row of voxels.
class DisplacementRow {
 public:
  /// @param nodeFromVoxel  from voxel indices to those of the grid; u has at least one point
  DisplacementRow(const DisplacementGrid &u, const Mat4 &nodeFromVoxel)
      : xyz_(u.xyz_mm.data()), gap_(u.gap_mm.data()), leastGap_(u.leastGap()), size_(u.geometry.size),
        nodeFromVoxel_(nodeFromVoxel) {
    std::size_t stride = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      gapStride_[a] = size_[a] > 1 ? stride : 0;
      stride_[a] = 3 * gapStride_[a];
      stride *= size_[a];
      last_[a] = static_cast<double>(size_[a] - 1);
      step_[a] = nodeFromVoxel[a];
    }
  }

  struct Part {
    std::size_t begin = 0, end = 0;  ///< indices along the row, end exclusive
  };

  /// Selects the row that begins at a point in voxel coordinates.
  void startAt(const Vec3 &voxel) { start_ = transformPoint(nodeFromVoxel_, voxel); }

  /// Selects the row of voxels j, k of that length. Outside the returned part the displacement is zero.
  Part moveTo(std::size_t j, std::size_t k, std::size_t length) {
    startAt({0.0, static_cast<double>(j), static_cast<double>(k)});
    double low = 0.0, high = static_cast<double>(length);
    for (std::size_t a = 0; a < 3; ++a) {
      const double lower = -kOnBorder - start_[a], upper = last_[a] + kOnBorder - start_[a];
      if (step_[a] == 0.0) {
        if (lower > 0.0 || upper < 0.0) high = 0.0;
        continue;
      }
      low = std::max(low, std::min(lower / step_[a], upper / step_[a]) - 1.0);  // at() checks exactly
      high = std::min(high, std::max(lower / step_[a], upper / step_[a]) + 2.0);
    }
    if (!(low < high)) return {};
    return {static_cast<std::size_t>(low), std::min(length, static_cast<std::size_t>(high))};
  }

  /// u at voxel i of the row, mm.
  [[nodiscard]] Vec3 at(std::size_t i) const {
    const std::optional<Place> place = placeOf(i);
    if (!place) return {};
    Vec3 u{};
    for (std::size_t c = 0; c < 3; ++c)
      u[c] = trilinear<Values::finite>(xyz_ + 3 * place->node + c, stride_, place->within);
    return u;
  }
  [[nodiscard]] bool isInside(std::size_t i) const { return placeOf(i).has_value(); }
  /// Whether the gap at voxel i exceeds leastGap(); true outside the grid.
  [[nodiscard]] bool hasGap(std::size_t i) const {
    const std::optional<Place> place = placeOf(i);
    return !place || trilinear<Values::finite>(gap_ + place->node, gapStride_, place->within) > leastGap_;
  }

 private:
  struct Place {
    std::size_t node = 0;  ///< index of the corner of its cell
    Vec3 within{};         ///< 0 … 1
  };
  [[nodiscard]] std::optional<Place> placeOf(std::size_t i) const {
    Place place;
    for (std::size_t a = 0; a < 3; ++a) {
      const double node = start_[a] + static_cast<double>(i) * step_[a];
      if (!(node >= -kOnBorder && node <= last_[a] + kOnBorder)) return std::nullopt;
      const double inside = std::clamp(node, 0.0, last_[a]);
      const std::size_t base = cellOf(inside, size_[a]);
      place.within[a] = inside - static_cast<double>(base);
      place.node += base * gapStride_[a];
    }
    return place;
  }

  const float *xyz_, *gap_;
  double leastGap_;
  std::array<std::size_t, 3> size_, stride_{}, gapStride_{};
  Vec3 last_{}, step_{}, start_{};
  Mat4 nodeFromVoxel_;
};

/// Determines which voxels of a grid are vacated, and which are fixed.
class EmptiedRegion {
 public:
  /// @param worldFromVoxel  of the queried grid; requires u.hasEmptiedRegion()
  EmptiedRegion(const DisplacementGrid &u, const Mat4 &worldFromVoxel)
      : bodies_(*u.bodies), leastWay_(0.25 * u.leastGap()), fromWorld_(affineInverse(bodies_.geometry.indexToWorld)),
        fromVoxel_(multiply(fromWorld_, worldFromVoxel)) {}

  /// @param row  the row of voxel i, whose index is `voxel`
  /// @param d    in: its displacement; out: 0 where it is fixed
  /// @return whether it is vacated
  [[nodiscard]] bool settles(const DisplacementRow &row, std::size_t i, const Vec3 &voxel, Vec3 &d) const {
    const std::uint8_t was = shownBefore(voxel, d);
    if (was == kBodyVoxel) return row.hasGap(i);
    if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0) return false;
    if (!stays(shownAt(transformPoint(fromVoxel_, voxel)))) {
      if (!stays(was)) return false;
      if (was == kRigidVoxel ? row.hasGap(i) : norm(d) > leastWay_) return true;
    }
    d = {};
    return false;
  }

  /// Whether a body is at voxel i now. @param d  displacement of the voxel
  [[nodiscard]] bool isBody(const DisplacementRow &row, std::size_t i, const Vec3 &voxel, const Vec3 &d) const {
    return shownBefore(voxel, d) == kBodyVoxel && !row.hasGap(i);
  }

 private:
  static bool stays(std::uint8_t shown) { return shown == kFixedVoxel || shown == kRigidVoxel; }
  [[nodiscard]] std::uint8_t shownBefore(const Vec3 &voxel, const Vec3 &d) const {
    const Vec3 now = transformPoint(fromVoxel_, voxel);
    return shownAt({now[0] - (fromWorld_[0] * d[0] + fromWorld_[4] * d[1] + fromWorld_[8] * d[2]),
                    now[1] - (fromWorld_[1] * d[0] + fromWorld_[5] * d[1] + fromWorld_[9] * d[2]),
                    now[2] - (fromWorld_[2] * d[0] + fromWorld_[6] * d[1] + fromWorld_[10] * d[2])});
  }
  /// 0 outside the grid.
  [[nodiscard]] std::uint8_t shownAt(const Vec3 &index) const {
    std::size_t at = 0, stride = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const double nearest = std::floor(index[a] + 0.5);
      if (!(nearest >= 0.0 && nearest < static_cast<double>(bodies_.geometry.size[a]))) return 0;
      at += stride * static_cast<std::size_t>(nearest);
      stride *= bodies_.geometry.size[a];
    }
    return bodies_.voxels[at];
  }

  const Mask &bodies_;
  double leastWay_;
  Mat4 fromWorld_, fromVoxel_;
};

}  // namespace c3de::imaging
