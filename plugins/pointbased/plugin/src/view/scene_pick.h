// SPDX-License-Identifier: Apache-2.0
// Picking of what is under the mouse.
#pragma once

#include <optional>
#include <vector>

#include "base/services.h"
#include "simulator/snapshot.h"

namespace pointbased {
/// In the frame of a simulation, m.
struct PickRay {
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();  ///< unit direction
  Vec3 view = Vec3::UnitZ();                              ///< unit, viewing direction of the camera

  /// Intersection with the plane through a point that is parallel to the screen; nothing if it is behind the eye.
  [[nodiscard]] std::optional<Vec3> onScreenPlane(const Vec3 &point) const;
};

/// Ray of an event; nothing if the node no longer exists. In a slice it starts in the displayed plane.
[[nodiscard]] std::optional<PickRay> rayOf(const Services &services, c3de_handle node, const c3de_event &event);

/// The first surface hit by a ray.
struct PickedSurface {
  const BodySnapshot *body = nullptr;          ///< one of the two is null
  const ObstacleSnapshot *obstacle = nullptr;  ///< at its present position
  std::uint32_t triangle = 0;
  double t = 0.0;              ///< m along the ray
  Vec3 at = Vec3::Zero();      ///< m
  Vec3 normal = Vec3::Zero();  ///< unit, towards the eye
};
/// Refits the pick trees of the bodies to the snapshot. Main thread.
[[nodiscard]] std::optional<PickedSurface> pick(const Services &services, const Snapshot &snapshot, const PickRay &ray);

/// The skin nearest to a position.
struct NearSkin {
  const BodySnapshot *body = nullptr;  ///< null if there is none
  double distance = 0.0;               ///< m, negative inside
  Vec3 outwards = Vec3::UnitZ();       ///< unit, out of the body along the shortest path
};
/// Proximity queries on a snapshot. Main thread. No other code may refit the pick trees of the bodies while
/// this object exists.
class Skins {
 public:
  /// Refits the pick trees to the snapshot, which must outlive this.
  Skins(const Services &services, const Snapshot &snapshot);
  /// The bodies that contain a position, m.
  [[nodiscard]] std::vector<const BodySnapshot *> bodiesAt(const Vec3 &place) const;
  /// Minimum over all bodies.
  [[nodiscard]] NearSkin nearestSkin(const Vec3 &place) const;

 private:
  const Services &services_;
  std::vector<const BodySnapshot *> bodies_;
};

}  // namespace pointbased
