// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "warp/displacement_rows.h"

namespace c3de::imaging {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

std::vector<std::uint8_t> pointsInTissue(const DisplacementGrid &u) {
  const auto &n = u.geometry.size;
  std::vector<std::uint8_t> inside(u.geometry.voxelCount(), 0);
  DisplacementRow row(u, kIdentity4);
  const EmptiedRegion bodies(u, u.geometry.indexToWorld);
  std::size_t p = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j) {
      row.startAt({0.0, static_cast<double>(j), static_cast<double>(k)});
      for (std::size_t i = 0; i < n[0]; ++i, ++p) {
        const Vec3 d{u.xyz_mm[3 * p], u.xyz_mm[3 * p + 1], u.xyz_mm[3 * p + 2]};
        const Vec3 voxel{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        inside[p] = bodies.isBody(row, i, voxel, d) ? 1 : 0;
      }
    }
  return inside;
}

/// Unknown points adjacent to known ones get the mean of their values.
void growByOne(const std::array<std::size_t, 3> &n, std::vector<float> &values) {
  const std::vector<float> before = values;
  const auto low = [](std::size_t at) { return at > 0 ? at - 1 : 0; };
  std::size_t p = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++p) {
        if (!std::isnan(before[p])) continue;
        float sum = 0.0F;
        int count = 0;
        for (std::size_t c = low(k); c <= std::min(k + 1, n[2] - 1); ++c)
          for (std::size_t b = low(j); b <= std::min(j + 1, n[1] - 1); ++b)
            for (std::size_t a = low(i); a <= std::min(i + 1, n[0] - 1); ++a)
              if (const float value = before[a + n[0] * (b + n[1] * c)]; !std::isnan(value)) sum += value, ++count;
        if (count > 0) values[p] = sum / static_cast<float>(count);
      }
}

}  // namespace

std::vector<float> volumeRatios(const DisplacementGrid &u) {
  std::vector<float> out(u.geometry.voxelCount(), kNothing);
  if (!u.hasEmptiedRegion() || u.xyz_mm.size() != 3 * out.size()) return out;
  const auto &n = u.geometry.size;
  const std::vector<std::uint8_t> inside = pointsInTissue(u);
  const Mat4 &m = u.geometry.indexToWorld;
  const double volume = dot(Vec3{m[0], m[1], m[2]}, cross(Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}));
  const std::array<std::size_t, 3> stride{1, n[0], n[0] * n[1]};
  std::size_t p = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++p) {
        if (inside[p] == 0) continue;
        const std::array<std::size_t, 3> at{i, j, k};
        // derivative of x - u with respect to each index, compared with that of x
        std::array<Vec3, 3> d{};
        bool isKnown = true;
        for (std::size_t a = 0; a < 3 && isKnown; ++a) {
          const std::size_t from = at[a] > 0 && inside[p - stride[a]] != 0 ? p - stride[a] : p,
                            to = at[a] + 1 < n[a] && inside[p + stride[a]] != 0 ? p + stride[a] : p;
          isKnown = from != to;
          const double steps = static_cast<double>((to - from) / stride[a]);
          for (std::size_t c = 0; c < 3 && isKnown; ++c)
            d[a][c] = m[4 * a + c] -
                      (static_cast<double>(u.xyz_mm[3 * to + c]) - static_cast<double>(u.xyz_mm[3 * from + c])) / steps;
        }
        const double ratio = isKnown ? volume / dot(d[0], cross(d[1], d[2])) : 0.0;
        // Where tissue overlaps itself, u is discontinuous and has no gradient.
        if (std::isfinite(ratio) && ratio > 0.0) out[p] = static_cast<float>(ratio);
      }
  growByOne(n, out);
  return out;
}

std::vector<float> scatterToGrid(const VolumeGeometry &grid, const MaterialPoints &points,
                                 std::span<const double> values) {
  const auto &n = grid.size;
  std::vector<float> sums(grid.voxelCount(), 0.0F), weights(sums.size(), 0.0F);
  const Mat4 toIndex = affineInverse(grid.indexToWorld);
  for (std::size_t q = 0; q < values.size(); ++q) {
    if (!std::isfinite(values[q])) continue;
    const Vec3 middle = transformPoint(toIndex, points.at_mm[q]);
    const double reach = points.reach_mm[q], perSquare = 1.0 / (reach * reach);
    std::array<std::size_t, 3> low{}, high{};
    bool isOutside = false;
    for (std::size_t a = 0; a < 3; ++a) {
      // The norm of a row of the inverse is the maximum change of an index per mm.
      const double way = reach * norm(Vec3{toIndex[a], toIndex[4 + a], toIndex[8 + a]});
      const double first = std::max(0.0, std::ceil(middle[a] - way)),
                   last = std::min(static_cast<double>(n[a]) - 1.0, std::floor(middle[a] + way));
      isOutside = isOutside || !(first <= last);
      if (isOutside) break;
      low[a] = static_cast<std::size_t>(first);
      high[a] = static_cast<std::size_t>(last);
    }
    if (isOutside) continue;
    const Mat4 &m = grid.indexToWorld;
    const Vec3 step{m[0], m[1], m[2]};
    for (std::size_t k = low[2]; k <= high[2]; ++k)
      for (std::size_t j = low[1]; j <= high[1]; ++j) {
        Vec3 way = grid.worldAt({static_cast<double>(low[0]), static_cast<double>(j), static_cast<double>(k)}) -
                   points.at_mm[q];
        std::size_t p = low[0] + n[0] * (j + n[1] * k);
        for (std::size_t i = low[0]; i <= high[0]; ++i, ++p, way = way + step) {
          const double share = 1.0 - perSquare * dot(way, way);
          if (!(share > 0.0)) continue;
          const auto weight = static_cast<float>(share * share * share);
          sums[p] += weight * static_cast<float>(values[q]);
          weights[p] += weight;
        }
      }
  }
  for (std::size_t p = 0; p < sums.size(); ++p) sums[p] = weights[p] > 0.0F ? sums[p] / weights[p] : kNothing;
  return sums;
}

}  // namespace c3de::imaging
