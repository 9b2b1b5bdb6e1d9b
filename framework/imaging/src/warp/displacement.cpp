// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/displacement.h"

#include "warp/displacement_rows.h"

namespace c3de::imaging {

Vec3 DisplacementGrid::at(const Vec3 &world) const {
  if (xyz_mm.empty()) return {};
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  Vec3 u = row.at(0);
  if (knowsVacated()) (void)Vacated(*this, kIdentity4).settles(row, 0, world, u);
  return u;
}

bool DisplacementGrid::isVacated(const Vec3 &world) const {
  if (!knowsVacated() || xyz_mm.empty()) return false;
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  Vec3 u = row.at(0);
  return Vacated(*this, kIdentity4).settles(row, 0, world, u);
}

double DisplacementGrid::leastGap() const {
  const Vec3 steps = geometry.spacing();
  return 0.5 * std::min({steps[0], steps[1], steps[2]});
}

}  // namespace c3de::imaging
