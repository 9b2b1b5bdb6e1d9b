// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <variant>

#include "pointbased/types.h"

namespace pointbased {

namespace detail {
class OccupancyField;
}

struct BoxRegion {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< m
};
struct SphereRegion {
  Vec3 centre = Vec3::Zero();  ///< m
  double radius = 0.0;         ///< m
};
/// The half-space on the side opposite to the normal.
struct HalfSpaceRegion {
  Vec3 point = Vec3::Zero();    ///< m
  Vec3 normal = Vec3::UnitX();  ///< of any length > 0
};
struct EverywhereRegion {};
/// Voxels of a grid that are filled by more than half: a tissue of a label map. Created by regionOf() (occupancy.h).
struct VoxelRegion {
  std::shared_ptr<const detail::OccupancyField> voxels;
  Vec3 offset = Vec3::Zero();  ///< m, from this frame to that of the voxels
};

/// A part of space in material coordinates. It selects the material of a body inside. Closed: includes its border.
using Region = std::variant<EverywhereRegion, BoxRegion, SphereRegion, HalfSpaceRegion, VoxelRegion>;

/// Signed distance to the border of the region, m, negative inside; -inf for everywhere.
[[nodiscard]] double signedDistance(const Region &region, const Vec3 &x);
/// Unit normal, outwards, at the point of the border nearest to x (one of them if several are equally near); zero for
/// everywhere.
[[nodiscard]] Vec3 borderNormal(const Region &region, const Vec3 &x);
/// Without tolerance: points exactly on the border are inside.
[[nodiscard]] bool contains(const Region &region, const Vec3 &x);
/// Same region in a frame whose origin is at `offset`: its coordinates minus the offset.
[[nodiscard]] Region shifted(const Region &region, const Vec3 &offset);
/// Errors: min above max, radius <= 0, normal of zero length, not finite.
[[nodiscard]] Result<void> validate(const Region &region);

}  // namespace pointbased
