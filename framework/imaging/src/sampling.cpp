// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/sampling.h"

#include <algorithm>
#include <type_traits>

namespace c3de::imaging {
namespace {

double between(double a, double b, double t) {
  return t == 0.0 ? a : a + t * (b - a);  // what is no number beside a voxel does not reach it
}

template <class T>
double valueAt(const T *voxels, const std::array<std::size_t, 3> &size, const Vec3 &index) {
  const std::array<std::size_t, 3> step{1, size[0], size[0] * size[1]};
  std::array<std::size_t, 3> next{};
  Vec3 t{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = std::clamp(index[a], 0.0, static_cast<double>(size[a] - 1));
    const std::size_t base = std::min(static_cast<std::size_t>(at), size[a] > 1 ? size[a] - 2 : 0);
    t[a] = at - static_cast<double>(base);
    voxels += base * step[a];
    next[a] = size[a] > 1 ? step[a] : 0;
  }
  const auto along = [&](const T *from) {
    return between(static_cast<double>(from[0]), static_cast<double>(from[next[0]]), t[0]);
  };
  const auto across = [&](const T *from) { return between(along(from), along(from + next[1]), t[1]); };
  return between(across(voxels), across(voxels + next[2]), t[2]);
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
