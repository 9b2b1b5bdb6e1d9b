// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/obstacle.h"

namespace pointbased {

/// Pose of a probe tool at a time.
struct ToolPose {
  double time = 0.0;          ///< s; of a quasi-static solution the load factor
  Vec3 at = Vec3::Zero();     ///< m, centre
  Vec3 axis = Vec3::UnitZ();  ///< of a capsule, of any length but 0
};

/// A rigid sphere, or a capsule: all within `radius` of a line segment. It moves along a path, at constant rate between
/// two poses, with its axis rotating by the smaller angle. It is static before the first and after the last pose.
struct ProbeTool {
  std::string name;
  double radius = 0.0;         ///< m, > 0
  double length = 0.0;         ///< m, >= 0, of the segment between the centres of the end caps; 0: a sphere
  double friction = 0.3;       ///< Coulomb, >= 0
  std::vector<ToolPose> path;  ///< at least two, ascending times
};

/// The tool as an analytic obstacle; at rest it is in the first pose of its path.
/// Errors: values outside of the ranges stated in ProbeTool; an axis that turns by 180 degrees from one pose to the
/// next, for which the direction of rotation is ambiguous.
[[nodiscard]] Result<Obstacle> obstacleOf(const ProbeTool &tool);

}  // namespace pointbased
