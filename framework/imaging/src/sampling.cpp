// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/sampling.h"

#include <algorithm>

#include "trilinear.h"

namespace c3de::imaging {
namespace {

template <class T>
double valueAt(const T *voxels, const std::array<std::size_t, 3> &size, const Vec3 &index) {
  const std::array<std::size_t, 3> step{1, size[0], size[0] * size[1]};
  std::array<std::size_t, 3> next{};
  Vec3 t{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = std::clamp(index[a], 0.0, static_cast<double>(size[a] - 1));
    const std::size_t base = cellOf(at, size[a]);
    t[a] = at - static_cast<double>(base);
    voxels += base * step[a];
    next[a] = size[a] > 1 ? step[a] : 0;
  }
  return trilinear<Values::any>(voxels, next, t);
}

}  // namespace

void sampleLinear(const Volume &volume, std::span<const Vec3> points, double outside, std::span<double> out) {
  const VolumeGeometry &g = volume.geometry;
  const Mat4 indexFromWorld = affineInverse(g.indexToWorld);
  std::visit(
      [&](const auto &all) {
        for (std::size_t p = 0; p < points.size(); ++p) {
          const Vec3 index = transformPoint(indexFromWorld, points[p]);
          bool inside = true;
          for (std::size_t a = 0; a < 3; ++a)  // false for NaN
            inside = inside && index[a] >= -0.5 && index[a] < static_cast<double>(g.size[a]) - 0.5;
          out[p] = inside ? volume.slope * valueAt(all.data(), g.size, index) + volume.intercept : outside;
        }
      },
      volume.voxels);
}

}  // namespace c3de::imaging
