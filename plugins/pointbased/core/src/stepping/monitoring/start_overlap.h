// SPDX-License-Identifier: Apache-2.0
// Overlap of bodies with obstacles, or with each other, before the first step. Private to the core.
#pragma once

#include <functional>

#include "contact/contact_skin.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// Overlap of a body and an obstacle.
struct ObstacleOverlap {
  double depth = 0.0;  ///< m, of the deepest point of either in the other; 0: no overlap
  /// Contact cannot separate them: the obstacle is inside the body, passes through it or cuts it.
  bool isEnclosed = false;
  Vec3 escape = Vec3::Zero();  ///< m, approximate translation by which an enclosed obstacle leaves the body
  Index phyxel = 0;            ///< nearest to the deepest point
  /// A contact point whose nearest obstacle surface faces out of the body, and the position to which it is moved along
  /// its inward normal instead.
  struct RedirectedPoint {
    Index point = 0;
    Vec3 position = Vec3::Zero();  ///< m, in the frame of the obstacle at rest
  };
  std::vector<RedirectedPoint> redirected;
};
/// @param skinOf  returns the skin of the body in its present position, or null without a surface; called if the two
///                are close to each other
/// @param motion  present motion of the obstacle
[[nodiscard]] ObstacleOverlap overlapWith(const Obstacle &obstacle, const RigidMotion &motion, const Body &body,
                                          const std::function<MovingSkin *()> &skinOf, const ParallelFor &parallelFor);

/// Bounding box of the phyxels of a body.
[[nodiscard]] SkinBox boundsOf(const Body &body);

/// Overlap of two bodies.
struct BodyOverlap {
  double depth = 0.0;  ///< m, of the deepest phyxel of either in the other
  double part = 0.0;   ///< 0 … 1, fraction of the mass: of the body with the larger fraction in the other
};
[[nodiscard]] BodyOverlap overlapBetween(const Body &first, MovingSkin &firstSkin, const Body &second,
                                         MovingSkin &secondSkin);

}  // namespace pointbased::detail
