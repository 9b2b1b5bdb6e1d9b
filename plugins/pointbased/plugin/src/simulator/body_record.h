// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/parameters.h"
#include "pointbased/probe_tool.h"
#include "report/accuracy_statement.h"
#include "simulator/body_builder.h"
#include "simulator/object_name.h"

namespace pointbased {

/// Data of a body besides its physics: its name, its source and the requests made for it.
struct BodyRecord {
  std::string name;
  std::shared_ptr<PlacedMesh> surface;
  std::shared_ptr<const ParameterValues> values;  ///< replaced, never modified: snapshots share it
  BodySource source;
  std::shared_ptr<const AccuracyPrediction> promise;  ///< null: its sampling was specified
  std::shared_ptr<const AdaptiveSampling> adaptive;   ///< null: finer cells were not requested
  std::shared_ptr<const DisplacementTrials> trials;   ///< null: not computed yet
  std::size_t order = 0;                              ///< order in which bodies were added, from 1; 0: not added yet
  std::uint32_t number = 0;                           ///< of ObjectName; 0: not added yet

  [[nodiscard]] ObjectName identity() const { return {name, number}; }

  /// As iface.simulator reports it. Its name is borrowed from this.
  [[nodiscard]] c3de_sim_body_info info(const Body &body) const;
  /// Takes over everything except the body.
  void assignBuilt(BuiltBody &built);
  /// Checks that a rigid body that is not free has no fix, load or velocity. Throws sdk::Error.
  void checkRigid() const;
  /// Checks that a body may move if these values make it rigid and free. Throws sdk::Error.
  void checkFree(const ParameterValues &with, bool quasiStatic) const;
  /// Checks that it is at most half a spacing (m) outside the walls. Throws sdk::Error.
  void checkInsideWalls(const WorldBox &box, double spacing) const;
  /// Checks that a point, m, is at most half a spacing (m) off the body. Throws sdk::Error, prefixed with `which`.
  void checkNearBody(const Services &services, const Vec3 &at, double spacing, const std::string &which) const;
};

struct ObstacleRecord {
  std::string name;
  std::shared_ptr<PlacedMesh> mesh;
  double friction = 0.0, restitution = 0.0;
  std::function<RigidMotion(double t)> motion;  ///< empty: static
  std::optional<ProbeTool> tool = {};           ///< none: the obstacle is a mesh
  std::uint32_t number = 0;                     ///< of ObjectName; 0: not added yet, or an instrument

  [[nodiscard]] ObjectName identity() const { return {name, number}; }
};

}  // namespace pointbased
