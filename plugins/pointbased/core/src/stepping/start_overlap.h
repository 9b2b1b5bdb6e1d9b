// SPDX-License-Identifier: Apache-2.0
// Where bodies and obstacles, or two bodies, overlap before the first step. Private to the core.
#pragma once

#include <functional>

#include "contact/contact_skin.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// A body and an obstacle.
struct ObstacleOverlap {
  double depth = 0.0;  ///< m, of the deepest point of either in the other; 0: they do not overlap
  /// Contact cannot separate them: the obstacle lies within the body, passes through it or cuts it.
  bool isEnclosed = false;
  Vec3 way = Vec3::Zero();  ///< m, by which the obstacle leaves the body, about; of what is enclosed
  Index phyxel = 0;         ///< nearest to the deepest point
  /// A point of contact whose nearest surface of the obstacle faces out of the body, and where it is led to along its
  /// inward normal instead.
  struct Led {
    Index point = 0;
    Vec3 place = Vec3::Zero();  ///< m, in the frame of the obstacle at rest
  };
  std::vector<Led> led;
};
/// @param skinOf  of the body where it is, or null: it has no surface; asked where the two come near each other
/// @param motion  of the obstacle at present
[[nodiscard]] ObstacleOverlap overlapWith(const Obstacle &obstacle, const RigidMotion &motion, const Body &body,
                                          const std::function<MovingSkin *()> &skinOf, const ParallelFor &parallelFor);

/// Around the phyxels of a body.
[[nodiscard]] SkinBox boundsOf(const Body &body);

/// Two bodies.
struct BodyOverlap {
  double depth = 0.0;  ///< m, of the deepest phyxel of either in the other
  double part = 0.0;   ///< of the mass, 0 … 1: of the body of which more lies in the other
};
[[nodiscard]] BodyOverlap overlapBetween(const Body &first, MovingSkin &firstSkin, const Body &second,
                                         MovingSkin &secondSkin);

}  // namespace pointbased::detail
