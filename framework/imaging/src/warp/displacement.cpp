// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/displacement.h"

#include <array>
#include <cmath>

#include "warp/displacement_rows.h"

namespace c3de::imaging {

Vec3 DisplacementGrid::continuousAt(const Vec3 &world) const {
  if (xyz_mm.empty()) return {};
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  return row.at(0);
}

Vec3 DisplacementGrid::at(const Vec3 &world) const {
  if (xyz_mm.empty()) return {};
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  Vec3 u = row.at(0);
  if (hasEmptiedRegion()) (void)EmptiedRegion(*this, kIdentity4).settles(row, 0, world, u);
  return u;
}

bool DisplacementGrid::isEmptied(const Vec3 &world) const {
  if (!hasEmptiedRegion() || xyz_mm.empty()) return false;
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  Vec3 u = row.at(0);
  return EmptiedRegion(*this, kIdentity4).settles(row, 0, world, u);
}

bool DisplacementGrid::hasTissue(const Vec3 &world) const {
  if (xyz_mm.empty()) return false;
  DisplacementRow row(*this, affineInverse(geometry.indexToWorld));
  row.startAt(world);
  if (!hasEmptiedRegion()) return row.isInside(0);
  return EmptiedRegion(*this, kIdentity4).isBody(row, 0, world, row.at(0));
}

const TissueField *DisplacementGrid::field(const std::string &name) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const TissueField &f) { return f.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

std::optional<double> DisplacementGrid::valueOf(const TissueField &field, const Vec3 &world) const {
  if (!hasTissue(world) || field.values.size() != geometry.voxelCount()) return std::nullopt;
  const Vec3 at = transformPoint(affineInverse(geometry.indexToWorld), world);
  // Uses only the corners of the cell that are near tissue.
  std::array<std::size_t, 3> base{};
  Vec3 within{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double inside = std::clamp(at[a], 0.0, static_cast<double>(geometry.size[a] - 1));
    base[a] = std::min(static_cast<std::size_t>(inside), geometry.size[a] > 1 ? geometry.size[a] - 2 : 0);
    within[a] = inside - static_cast<double>(base[a]);
  }
  double sum = 0.0, weights = 0.0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::size_t node = 0, stride = 1;
    double weight = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t up = corner >> a & 1U;
      weight *= up != 0 ? within[a] : 1.0 - within[a];
      node += stride * std::min(base[a] + up, geometry.size[a] - 1);
      stride *= geometry.size[a];
    }
    if (weight == 0.0 || std::isnan(field.values[node])) continue;
    sum += weight * static_cast<double>(field.values[node]);
    weights += weight;
  }
  if (!(weights > 0.0)) return std::nullopt;
  return sum / weights;
}

double DisplacementGrid::leastGap() const {
  const Vec3 steps = geometry.spacing();
  return 0.5 * std::min({steps[0], steps[1], steps[2]});
}

}  // namespace c3de::imaging
