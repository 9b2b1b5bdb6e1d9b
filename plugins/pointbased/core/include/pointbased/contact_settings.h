// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <utility>

#include "pointbased/types.h"

namespace pointbased {

/// Id of the walls of the world box, used in place of the id of a body or an obstacle.
inline constexpr std::size_t kWorldBox = 0;

/// Contact of bodies with each other and with themselves. Obstacles and walls have separate settings (Obstacle,
/// WorldBox) and act whatever is set here.
struct ContactSettings {
  /// Between bodies, within a body, and between soft and rigid tissue of a body (voxels of a fix)
  bool enabled = true;
  bool self = true;       ///< contact of a body's skin with itself, if enabled
  double friction = 0.3;  ///< Coulomb, >= 0; of pairs without a friction of their own
  bool operator==(const ContactSettings &) const = default;
};

/// Contact of one pair: two bodies, or a body and an obstacle or the walls.
struct ContactPairSettings {
  double friction = -1.0;  ///< Coulomb; negative: ContactSettings::friction, or that of the obstacle or the walls
  bool enabled = true;     ///< false: they pass through each other
  /// The bodies touch in their initial configuration, such as the pieces of one cut body. Overlap found at the first
  /// check is attributed to their skins, not to the bodies. It is kept and does not count as penetration.
  bool fits = false;
  bool operator==(const ContactPairSettings &) const = default;
};

/// Settings of pairs, by ids: the smaller one first.
using ContactPairs = std::map<std::pair<std::size_t, std::size_t>, ContactPairSettings>;

/// Contact between two that touch.
struct ContactSummary {
  std::size_t first = 0;      ///< id of a body
  std::size_t second = 0;     ///< id of a body or an obstacle; kWorldBox: the walls
  Vec3 force = Vec3::Zero();  ///< N, on `first`, mean over the last step
  double normalForce = 0.0;   ///< N, sum of the normal forces, mean over the last step
  /// m, >= 0: of the deepest point at the end of the last step; 0 for touching without penetration
  double depth = 0.0;
  std::size_t points = 0;  ///< number of contact points with a contact force at the end of the last step
  double area = 0.0;       ///< m², at rest, of the skin around these points; between bodies the mean of both
};

}  // namespace pointbased
