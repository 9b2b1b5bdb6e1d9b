// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/displacement.h"

#include "displacement_rows.h"

namespace c3de::imaging {

Vec3 DisplacementGrid::at(const Vec3 &world) const {
  if (xyz_mm.empty()) return {};
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  return row.at(0);
}

bool DisplacementGrid::isVacated(const Vec3 &world) const {
  if (!knowsVacated() || xyz_mm.empty()) return false;
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  return Vacated(*this, kIdentity4).has(row, 0, world, row.at(0));
}

double DisplacementGrid::leastGap() const {
  const Vec3 steps = geometry.spacing();
  return 0.5 * std::min({steps[0], steps[1], steps[2]});
}

}  // namespace c3de::imaging
