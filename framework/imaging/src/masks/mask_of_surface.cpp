// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/imaging/mask_coverage.h"
#include "c3de/imaging/masks.h"

namespace c3de::imaging {
namespace {

// Integers n with low < n <= high within 0 … count - 1, as a half-open range. The same rule is used everywhere, so that
// a row through an edge or a vertex crosses each surface once.
struct Range {
  std::size_t begin = 0, end = 0;
};
Range wholeBetween(double low, double high, std::size_t count) {
  const double most = static_cast<double>(count);
  return {static_cast<std::size_t>(std::clamp(std::floor(low) + 1.0, 0.0, most)),
          static_cast<std::size_t>(std::clamp(std::floor(high) + 1.0, 0.0, most))};
}

}  // namespace

Mask maskOf(const geometry::TriangleMesh &closed, const VolumeGeometry &grid) {
  Mask mask;
  mask.geometry = grid;
  mask.voxels.assign(grid.voxelCount(), 0);
  const Mat4 indexFromWorld = affineInverse(grid.indexToWorld);
  std::vector<Vec3> at(closed.vertices.size());
  std::transform(closed.vertices.begin(), closed.vertices.end(), at.begin(),
                 [&](const Vec3 &x) { return transformPoint(indexFromWorld, x); });
  const std::array<std::size_t, 3> &n = grid.size;
  // Every face toggles the first voxel after it in each row that it crosses; voxels after an odd count are inside.
  for (const Triangle &triangle : closed.triangles) {
    // Ends of an edge in index order, so that both adjacent faces compute the same points.
    const auto cut = [&](std::size_t side, double k) {
      std::size_t a = triangle[side], b = triangle[(side + 1) % 3];
      if (a > b) std::swap(a, b);
      const double t = (k - at[a][2]) / (at[b][2] - at[a][2]);
      return std::array<double, 2>{at[a][0] + t * (at[b][0] - at[a][0]), at[a][1] + t * (at[b][1] - at[a][1])};
    };
    const auto [low, high] = std::minmax({at[triangle[0]][2], at[triangle[1]][2], at[triangle[2]][2]});
    if (!std::isfinite(low) || !std::isfinite(high)) continue;
    const Range ks = wholeBetween(low, high, n[2]);
    for (std::size_t k = ks.begin; k < ks.end; ++k) {
      const double height = static_cast<double>(k);
      std::array<std::array<double, 2>, 2> ends{};
      std::size_t count = 0;
      for (std::size_t side = 0; side < 3 && count < 2; ++side) {
        const bool fromBelow = at[triangle[side]][2] < height, toBelow = at[triangle[(side + 1) % 3]][2] < height;
        if (fromBelow != toBelow) ends[count++] = cut(side, height);
      }
      if (count < 2) continue;
      // Here too the order of the ends must not depend on the face.
      if (ends[1][1] < ends[0][1]) std::swap(ends[0], ends[1]);
      const Range js = wholeBetween(ends[0][1], ends[1][1], n[1]);
      for (std::size_t j = js.begin; j < js.end; ++j) {
        const double t = (static_cast<double>(j) - ends[0][1]) / (ends[1][1] - ends[0][1]);
        const double i = std::ceil(ends[0][0] + t * (ends[1][0] - ends[0][0]));
        if (i < static_cast<double>(n[0]))
          mask.voxels[static_cast<std::size_t>(std::max(i, 0.0)) + n[0] * (j + n[1] * k)] ^= 1;
      }
    }
  }
  for (std::size_t row = 0; row < n[1] * n[2]; ++row)
    for (std::size_t i = 1; i < n[0]; ++i) mask.voxels[row * n[0] + i] ^= mask.voxels[row * n[0] + i - 1];
  return mask;
}

Mask notEnclosed(const Mask &mask, const geometry::TriangleMesh &surface) {
  const Mask inside = maskOf(surface, mask.geometry);
  const auto &n = mask.geometry.size;
  const std::array<std::size_t, 3> step{1, n[0], n[0] * n[1]};
  Mask out{mask.geometry, std::vector<std::uint8_t>(mask.voxels.size(), 0)};
  std::size_t v = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++v) {
        if (mask.voxels[v] == 0 || inside.voxels[v] != 0) continue;
        const std::array<std::size_t, 3> at{i, j, k};
        bool isNear = false;
        for (std::size_t a = 0; a < 3; ++a)
          isNear = isNear || (at[a] > 0 && inside.voxels[v - step[a]] != 0) ||
                   (at[a] + 1 < n[a] && inside.voxels[v + step[a]] != 0);
        out.voxels[v] = isNear ? 0 : 1;
      }
  return out;
}

}  // namespace c3de::imaging
