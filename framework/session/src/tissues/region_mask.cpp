// SPDX-License-Identifier: Apache-2.0
#include "tissues/region_mask.h"

#include "c3de/scene/simulation.h"

namespace c3de::session {
namespace {

bool isWithin(const scene::SceneRegion &region, const Vec3 &at_m) {
  switch (region.kind) {
    case scene::SceneRegion::Kind::box:
      for (std::size_t a = 0; a < 3; ++a)
        if (!(at_m[a] >= region.a[a] && at_m[a] <= region.b[a])) return false;
      return true;
    case scene::SceneRegion::Kind::sphere: return norm(at_m - region.a) <= region.radius;
    case scene::SceneRegion::Kind::halfSpace: return dot(at_m - region.a, region.b) <= 0.0;
    case scene::SceneRegion::Kind::everywhere:
    case scene::SceneRegion::Kind::voxels: break;
  }
  return true;
}

}  // namespace

void keepWithin(const scene::SceneRegion &region, imaging::Mask &mask) {
  const auto &size = mask.geometry.size;
  std::size_t v = 0;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i, ++v) {
        if (mask.voxels[v] == 0) continue;
        const Vec3 at_mm =
            mask.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        if (!isWithin(region, (1.0 / scene::kMillimetresPerMetre) * at_mm)) mask.voxels[v] = 0;
      }
}

}  // namespace c3de::session
