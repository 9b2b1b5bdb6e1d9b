// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "c3de/imaging/displacement.h"
#include "trilinear.h"

namespace c3de::imaging {

/// Indices this far outside of a grid are on its border: a way through two matrices leaves some 1e-13.
constexpr double kOnBorder = 1e-6;

/// Displacements along one row of voxels.
class DisplacementRow {
 public:
  /// @param nodeFromVoxel  from indices of the voxels to those of the grid; u has a point at least
  DisplacementRow(const DisplacementGrid &u, const Mat4 &nodeFromVoxel)
      : xyz_(u.xyz_mm.data()), size_(u.geometry.size), nodeFromVoxel_(nodeFromVoxel) {
    std::size_t stride = 3;
    for (std::size_t a = 0; a < 3; ++a) {
      stride_[a] = size_[a] > 1 ? stride : 0;
      stride *= size_[a];
      last_[a] = static_cast<double>(size_[a] - 1);
      step_[a] = nodeFromVoxel[a];
    }
  }

  struct Part {
    std::size_t begin = 0, end = 0;  ///< indices along the row, the last one not included
  };

  /// To a row that begins at a point in the coordinates of voxels.
  void startAt(const Vec3 &voxel) { start_ = transformPoint(nodeFromVoxel_, voxel); }

  /// To the row of voxels j, k of that length. Outside of the part nothing is displaced.
  Part moveTo(std::size_t j, std::size_t k, std::size_t length) {
    startAt({0.0, static_cast<double>(j), static_cast<double>(k)});
    double low = 0.0, high = static_cast<double>(length);
    for (std::size_t a = 0; a < 3; ++a) {
      const double lower = -kOnBorder - start_[a], upper = last_[a] + kOnBorder - start_[a];
      if (step_[a] == 0.0) {
        if (lower > 0.0 || upper < 0.0) high = 0.0;
        continue;
      }
      low = std::max(low, std::min(lower / step_[a], upper / step_[a]) - 1.0);  // at() looks closely
      high = std::min(high, std::max(lower / step_[a], upper / step_[a]) + 2.0);
    }
    if (!(low < high)) return {};
    return {static_cast<std::size_t>(low), std::min(length, static_cast<std::size_t>(high))};
  }

  /// u at voxel i of the row, mm.
  [[nodiscard]] Vec3 at(std::size_t i) const {
    Vec3 t{};
    const float *corner = xyz_;
    for (std::size_t a = 0; a < 3; ++a) {
      const double node = start_[a] + static_cast<double>(i) * step_[a];
      if (!(node >= -kOnBorder && node <= last_[a] + kOnBorder)) return {};
      const double inside = std::clamp(node, 0.0, last_[a]);
      const std::size_t base = cellOf(inside, size_[a]);
      t[a] = inside - static_cast<double>(base);
      corner += base * stride_[a];
    }
    Vec3 u{};
    for (std::size_t c = 0; c < 3; ++c, ++corner) u[c] = trilinear<Values::finite>(corner, stride_, t);
    return u;
  }

 private:
  const float *xyz_;
  std::array<std::size_t, 3> size_, stride_{};
  Vec3 last_{}, step_{}, start_{};
  Mat4 nodeFromVoxel_;
};

}  // namespace c3de::imaging
