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

}  // namespace c3de::imaging
