// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "accuracy_statement.h"
#include "body_builder.h"
#include "parameters.h"
#include "pointbased/probe_tool.h"

namespace pointbased {

/// What is known of a body beside its physics: what it is called, made of and was asked for.
struct BodyRecord {
  std::string name;
  std::shared_ptr<PlacedMesh> surface;
  std::shared_ptr<const ParameterValues> values;  ///< replaced, never changed: snapshots share it
  BodySource source;
  std::shared_ptr<const AccuracyPromise> promise;    ///< null: its sampling was said
  std::shared_ptr<const AdaptiveSampling> adaptive;  ///< null: finer cells were not asked for
  std::shared_ptr<const DisplacementTrials> trials;  ///< null: not made yet
  std::size_t order = 0;                             ///< from 1, as bodies were added; 0: not added yet

  /// As iface.simulator tells it; its name is borrowed from this.
  [[nodiscard]] c3de_sim_body_info info(const Body &body) const;
  /// All of it but the body.
  void take(BuiltBody &built);
  /// That nothing is asked of a rigid body that it would not do. Errors as sdk::Error.
  void checkRigid() const;
  /// That a body may move if these values make it rigid and free. Errors as sdk::Error.
  void checkFree(const ParameterValues &with, bool quasiStatic) const;
  /// That it is not more than half a spacing (m) outside of the walls. Errors as sdk::Error.
  void checkIsIn(const WorldBox &box, double spacing) const;
  /// That a point, m, is at most half a spacing (m) off it. Errors as sdk::Error, `which` in front.
  void checkReaches(const Services &services, const Vec3 &at, double spacing, const std::string &which) const;
};

struct ObstacleRecord {
  std::string name;
  std::shared_ptr<PlacedMesh> mesh;
  double friction = 0.0, restitution = 0.0;
  std::function<RigidMotion(double t)> motion;  ///< empty: stands still
  std::optional<ProbeTool> tool = {};           ///< none: made of a mesh
};

}  // namespace pointbased
