// SPDX-License-Identifier: Apache-2.0
// What lies under the mouse.
#pragma once

#include <optional>

#include "services.h"
#include "snapshot.h"

namespace pointbased {

/// In the frame of a simulation, m.
struct PickRay {
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();  ///< unit direction
  Vec3 view = Vec3::UnitZ();                              ///< unit, where the camera looks

  /// Where it passes the plane through a point that is parallel to the screen; nothing: behind the eye.
  [[nodiscard]] std::optional<Vec3> onScreenPlane(const Vec3 &point) const;
};

/// Of an event of the 3D view; nothing: the node is gone.
[[nodiscard]] std::optional<PickRay> rayOf(const Services &services, c3de_handle node, const c3de_event &event);

/// The first surface that a ray meets.
struct PickedSurface {
  const BodySnapshot *body = nullptr;          ///< one of the two is null
  const ObstacleSnapshot *obstacle = nullptr;  ///< where it is now
  std::uint32_t triangle = 0;
  double t = 0.0;              ///< m along the ray
  Vec3 at = Vec3::Zero();      ///< m
  Vec3 normal = Vec3::Zero();  ///< unit, towards the eye
};
/// Refits the trees of the bodies to the snapshot. Main thread.
[[nodiscard]] std::optional<PickedSurface> pick(const Services &services, const Snapshot &snapshot, const PickRay &ray);

}  // namespace pointbased
