// SPDX-License-Identifier: Apache-2.0
#include "surface_part.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace c3de::embed {
namespace {

constexpr double kRoundOff = 1e-9;  // of the extent of a surface

/// Adds polygons; equal positions become one corner.
class PartBuilder {
 public:
  void add(const std::vector<Vec3> &polygon) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const std::array<std::uint32_t, 3> triangle{corner(polygon[0]), corner(polygon[i - 1]), corner(polygon[i])};
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        part_.triangles.push_back(triangle);
    }
  }
  [[nodiscard]] SurfacePart take() { return std::move(part_); }

 private:
  std::uint32_t corner(const Vec3 &x) {
    const auto [found, isNew] = corners_.emplace(x, static_cast<std::uint32_t>(part_.positions.size()));
    if (isNew) part_.positions.push_back(x);
    return found->second;
  }

  SurfacePart part_;
  std::map<std::array<double, 3>, std::uint32_t> corners_;
};

/// What of a polygon is on one side of a face of a box: coordinate * sign <= limit * sign.
/// @param margin  corners at that distance or less are on the face
std::vector<Vec3> cut(const std::vector<Vec3> &polygon, std::size_t axis, double limit, double sign, double margin) {
  const auto beyond = [&](const Vec3 &x) {
    const double distance = sign * (x[axis] - limit);
    return std::abs(distance) <= margin ? 0.0 : distance;
  };
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = beyond(a), db = beyond(b);
    if (da <= 0.0) out.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      Vec3 x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = a[k] + da / (da - db) * (b[k] - a[k]);
      x[axis] = limit;
      out.push_back(x);
    }
  }
  return out;
}

}  // namespace

SurfacePart partInBox(std::span<const Vec3> positions, const Triangles &triangles, const Vec3 &min, const Vec3 &max) {
  // A plane side through a face of the box has corners on either side of it, by round-off.
  double extent = 0.0;
  for (const Vec3 &x : positions)
    for (std::size_t axis = 0; axis < 3; ++axis) extent = std::max(extent, std::abs(x[axis] - positions.front()[axis]));
  const double margin = kRoundOff * extent;
  PartBuilder builder;
  for (const auto &triangle : triangles) {
    std::vector<Vec3> polygon{positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]};
    for (std::size_t axis = 0; axis < 3 && !polygon.empty(); ++axis)
      polygon = cut(cut(polygon, axis, max[axis], 1.0, margin), axis, min[axis], -1.0, margin);
    builder.add(polygon);
  }
  return builder.take();
}

SurfacePart partOfVertices(std::span<const Vec3> positions, const Triangles &triangles,
                           const std::vector<bool> &chosen) {
  PartBuilder builder;
  for (const auto &triangle : triangles)
    if (chosen[triangle[0]] && chosen[triangle[1]] && chosen[triangle[2]])
      builder.add({positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]});
  return builder.take();
}

}  // namespace c3de::embed
