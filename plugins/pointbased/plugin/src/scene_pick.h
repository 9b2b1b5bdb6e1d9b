// SPDX-License-Identifier: Apache-2.0
// What lies under the mouse.
#pragma once

#include <optional>
#include <vector>

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

/// Of an event; nothing: the node is gone. In a slice it begins in the plane that is shown.
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

/// The skin that is nearest to a place.
struct NearSkin {
  const BodySnapshot *body = nullptr;  ///< null: there is none
  double distance = 0.0;               ///< m, negative inside
  Vec3 outwards = Vec3::UnitZ();       ///< unit, out of the body, the shortest way
};
/// What is near in a snapshot. Main thread; while it is there nobody else refits the trees of the bodies.
class Skins {
 public:
  /// Refits the trees to the snapshot, which must stay.
  Skins(const Services &services, const Snapshot &snapshot);
  /// The bodies whose inside is at a place, m.
  [[nodiscard]] std::vector<const BodySnapshot *> bodiesAt(const Vec3 &place) const;
  /// Of all bodies together.
  [[nodiscard]] NearSkin near(const Vec3 &place) const;

 private:
  const Services &services_;
  std::vector<const BodySnapshot *> bodies_;
};

}  // namespace pointbased
