// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/accuracy_target.h"
#include "instruments/grasp.h"
#include "pointbased/simulator.h"
#include "report/accuracy_statement.h"

namespace pointbased {

struct ReportedBody {
  std::size_t id;
  double meshVolume;  ///< m³
  double meshArea;    ///< m²
  std::vector<std::uint32_t> fixNumbers;
  std::span<const std::string> fixNames;
  std::shared_ptr<const AccuracyPrediction> promise;  ///< null: its sampling was specified
  std::shared_ptr<const AdaptiveSampling> adaptive;   ///< null: finer cells were not requested
  std::shared_ptr<const DisplacementTrials> trials;   ///< null: not computed yet
  const BodyVerification *verification = nullptr;     ///< of the present state; null if there is none
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
  std::array<std::string, 2> names;          ///< of the joined objects
  double stiffness = 0.0, tangential = 0.0;  ///< Pa/m
};

/// A support or load on a part of a surface, set while the body was simulated.
struct ReportedCondition {
  std::string name, kind, body;
  double area = 0.0;           ///< m²
  Vec3 force = Vec3::Zero();   ///< N, on the body
  Vec3 vector = Vec3::Zero();  ///< N or m, as set
  double pressure = 0.0;       ///< Pa, as set
  std::string warning;
};

/// Integrator and method of force computation, as display text: "explicit, double precision, AVX3".
[[nodiscard]] std::string describeComputation(const Simulator &simulator, std::size_t body);

/// The keys accuracy, attachments, bodies, probes, probe_tools, grasps, contacts, reactions, stages, events and notices
/// of the run report, as one JSON object.
/// @param nameOfId  of a body, an obstacle or kWorldBox
[[nodiscard]] std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies,
                                     const std::vector<ReportedTool> &tools,
                                     const std::vector<ReportedAttachment> &attachments,
                                     const std::vector<ReportedGrasp> &grasps,
                                     const std::vector<ReportedCondition> &conditions,
                                     const std::function<std::string(std::size_t id)> &nameOfId);

}  // namespace pointbased
