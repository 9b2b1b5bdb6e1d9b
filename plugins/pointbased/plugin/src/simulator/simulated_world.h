// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "base/parameters.h"
#include "base/step_request.h"
#include "fields/evaluation_points.h"
#include "simulator/body_table.h"
#include "simulator/grasp_record.h"
#include "simulator/plugin_context.h"

namespace pointbased {

/// The data of a WorldSimulator that its parts share. The mutex serialises the solver's step and the additions and
/// reads of other threads; it guards the members below it, and is held in every call of this.
struct SimulatedWorld {
  explicit SimulatedWorld(PluginContext &of) : context(of), simulator(of.services.parallelFor()) {}

  /// Returns to the initial state, with the jaws of the scene and without instruments.
  void reset();
  /// Ids of loads, holds and grasps, above those of bodies, obstacles and probes.
  [[nodiscard]] std::uint64_t allocateIds(std::uint64_t count);
  /// Stores the position of a grab for the trial of an adaptive sampling: the last eight positions of a body.
  void recordGrab(std::uint64_t body, const Grab &grab);
  /// Stores the pull of a grab likewise.
  void recordPull(std::uint64_t body, std::uint64_t grabId);

  PluginContext &context;
  StepInterrupt request;
  std::mutex mutex;
  Simulator simulator;
  ParameterValues parameters{worldDeclarations()};
  BodyTable table;
  EvaluationPoints points;
  std::map<std::uint64_t, GraspRecord> grasps;
  std::uint64_t nextId = std::uint64_t{1} << 32;
  std::uint64_t resets = 0;  ///< number of resets so far
};

}  // namespace pointbased
