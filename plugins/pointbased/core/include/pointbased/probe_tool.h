// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/obstacle.h"

namespace pointbased {

/// Where a probe tool is at a time.
struct ToolPlace {
  double time = 0.0;          ///< s; of a quasi-static solution the load factor
  Vec3 at = Vec3::Zero();     ///< m, the middle
  Vec3 axis = Vec3::UnitZ();  ///< of a capsule, of any length but 0
};

/// A rigid sphere, or a capsule: all within `radius` of a line. It is led along a path, evenly between two places, its
/// axis the shorter way, and stands still before the first and after the last place.
struct ProbeTool {
  std::string name;
  double radius = 0.0;          ///< m, > 0
  double length = 0.0;          ///< m, >= 0, of the line between the middles of the ends; 0: a sphere
  double friction = 0.3;        ///< Coulomb, >= 0
  std::vector<ToolPlace> path;  ///< at least two, times ascend
};

/// The tool as an obstacle by formulas; at rest it is at the first place of its path. Errors: what is not as ProbeTool
/// says, and an axis that turns by 180 degrees from one place to the next, which no way is the shorter one for.
[[nodiscard]] Result<Obstacle> obstacleOf(const ProbeTool &tool);

}  // namespace pointbased
