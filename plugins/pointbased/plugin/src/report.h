// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "accuracy_dial.h"
#include "accuracy_statement.h"
#include "grasp.h"
#include "pointbased/simulator.h"

namespace pointbased {

struct ReportedBody {
  std::size_t id;
  double meshVolume;  ///< m³
  double meshArea;    ///< m²
  std::vector<std::uint32_t> fixNumbers;
  std::span<const std::string> fixNames;
  std::shared_ptr<const AccuracyPromise> promise;    ///< null: its sampling was said
  std::shared_ptr<const AdaptiveSampling> adaptive;  ///< null: finer cells were not asked for
  std::shared_ptr<const DisplacementTrials> trials;  ///< null: not made yet
  const BodyVerification *verification = nullptr;    ///< of the present state; null: none
};

struct ReportedTool {
  std::string name;
  Vec3 position = Vec3::Zero();  ///< m, of its middle
  Vec3 force = Vec3::Zero();     ///< N, of all bodies on it
  double depth = 0.0;            ///< m
  std::size_t points = 0;
};

struct ReportedGrasp {
  std::string name;
  bool holds = false;
  GraspForces forces = {};
};

struct ReportedAttachment {
  AttachmentSummary now;
  std::array<std::string, 2> names;          ///< of what it joins
  double stiffness = 0.0, tangential = 0.0;  ///< Pa/m
};

/// What integrates a body and what computes its forces, for people: "explicit, double precision, AVX3".
[[nodiscard]] std::string howComputed(const Simulator &simulator, std::size_t body);

/// The keys accuracy, attachments, bodies, probes, probe_tools, grasps, contacts, reactions, stages, events and notices
/// of the run report, as one JSON object.
/// @param nameOfId  of a body, an obstacle or kWorldBox
[[nodiscard]] std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies,
                                     const std::vector<ReportedTool> &tools,
                                     const std::vector<ReportedAttachment> &attachments,
                                     const std::vector<ReportedGrasp> &grasps,
                                     const std::function<std::string(std::size_t id)> &nameOfId);

}  // namespace pointbased
