// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "instruments/grasp.h"

namespace pointbased {

/// A pose of a scene's jaws on their path.
struct GraspPose {
  double time = 0.0;                                             ///< s
  Vec3 at = Vec3::Zero();                                        ///< m, of the middle between the jaws
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< since the start of the grasp
};
struct SceneGrasp {
  std::uint64_t body = 0;
  JawPositions jaws;
  GraspSettings settings;
  std::vector<GraspPose> path;  ///< empty: they keep their initial pose

  [[nodiscard]] double startTime() const;  ///< s
  /// Sets the prescribed pose at a time.
  void applyPose(Grasp &grasp, double time) const;
};
struct GraspRecord {
  std::string name;
  std::optional<SceneGrasp> scene;  ///< none: controlled interactively
  std::optional<Grasp> now;         ///< none: holds nothing
  bool isReleased = false;          ///< has released, until the simulation is restarted

  [[nodiscard]] std::uint64_t body() const { return scene ? scene->body : now->body; }
};

}  // namespace pointbased
