// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/displacement.h"

#include <algorithm>
#include <cmath>

namespace c3de::imaging {

Vec3 DisplacementGrid::at(const Vec3 &world) const {
  const Vec3 node = transformPoint(affineInverse(geometry.indexToWorld), world);
  std::array<std::size_t, 3> base{};
  Vec3 t{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(node[a] >= 0.0) || !(node[a] <= static_cast<double>(geometry.size[a] - 1))) return {};
    base[a] = std::min(static_cast<std::size_t>(node[a]), geometry.size[a] > 1 ? geometry.size[a] - 2 : 0);
    t[a] = node[a] - static_cast<double>(base[a]);
  }
  Vec3 u{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<std::size_t, 3> at = base;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool isUpper = (corner >> a & 1u) != 0;
      weight *= isUpper ? t[a] : 1.0 - t[a];
      at[a] = std::min(at[a] + (isUpper ? 1 : 0), geometry.size[a] - 1);
    }
    const float *value = xyz_mm.data() + 3 * (at[0] + geometry.size[0] * (at[1] + geometry.size[1] * at[2]));
    for (std::size_t a = 0; a < 3; ++a) u[a] += weight * static_cast<double>(value[a]);
  }
  return u;
}

}  // namespace c3de::imaging
