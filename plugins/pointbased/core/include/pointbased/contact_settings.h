// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pointbased/types.h"

namespace pointbased {

/// Stands for the walls of the world box where the id of a body or an obstacle is asked for.
inline constexpr std::size_t kWorldBox = 0;

/// Contact of bodies with each other and with themselves. Obstacles and walls have settings of their own (Obstacle,
/// WorldBox) and are felt whatever stands here.
struct ContactSettings {
  /// Between bodies, of bodies with themselves, and of soft tissue with rigid tissue of its body (voxels of a fix)
  bool enabled = true;
  bool self = true;       ///< of skins of bodies with themselves, where enabled
  double friction = 0.3;  ///< Coulomb, >= 0; of pairs that have none of their own
  bool operator==(const ContactSettings &) const = default;
};

/// Contact of one pair: two bodies, or a body and an obstacle or the walls.
struct ContactPairSettings {
  double friction = -1.0;  ///< Coulomb; negative: ContactSettings::friction, or that of the obstacle or the walls
  bool enabled = true;     ///< false: they pass through each other
  /// Two bodies lie on each other as they are when they are looked at for the first time, such as pieces of what was
  /// one: what overlaps then is of their skins, not of them, and stays; it is no depth.
  bool fits = false;
  bool operator==(const ContactPairSettings &) const = default;
};

/// What passes between two that touch.
struct ContactSummary {
  std::size_t first = 0;      ///< id of a body
  std::size_t second = 0;     ///< id of a body or an obstacle; kWorldBox: the walls
  Vec3 force = Vec3::Zero();  ///< N, on `first`, mean over the last step
  double pressing = 0.0;      ///< N, sum of the normal forces, mean over the last step
  double depth = 0.0;         ///< m, >= 0: of the deepest point at the end of the last step; 0 when it only touches
  std::size_t points = 0;     ///< of contact that pressed at the end of the last step
  double area = 0.0;  ///< m², at rest, of the skin that belongs to these points; between bodies the mean of both
};

}  // namespace pointbased
