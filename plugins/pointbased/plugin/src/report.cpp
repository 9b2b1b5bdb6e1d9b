// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "advice.h"
#include "pointbased/cloud_quality.h"
#include "pointbased/error_estimate.h"
#include "pointbased/plasticity.h"

namespace pointbased {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3 &v) { return {v[0], v[1], v[2]}; }

const char *nameOf(Integrator integrator) {
  switch (integrator) {
    case Integrator::automatic: return "auto";
    case Integrator::explicitVerlet: return "explicit";
    case Integrator::implicitSdirk: return "implicit";
    case Integrator::implicitMidpoint: return "midpoint";
    case Integrator::backwardEuler: return "backward_euler";
    case Integrator::quasiStatic: return "quasistatic";
  }
  return "";
}

Json bodyJson(const Simulator &simulator, const ReportedBody &reported, const ErrorEstimate &error) {
  const Body &body = *simulator.body(reported.id);
  const RestState &rest = body.rest();
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero(), centre = Vec3::Zero();
  double mass = 0.0, volume = 0.0;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const double m = body.masses()[i] + (body.supportMasses().empty() ? 0.0 : body.supportMasses()[i]);
    const Vec3 x = rest.origin + rest.positions[i] + body.state().displacements[i];
    const Vec3 &v = body.state().velocities[i];
    momentum += m * v;
    angular += m * x.cross(v);
    centre += m * x;
    mass += m;
    volume += rest.volumes[i];
  }
  if (mass > 0.0) centre /= mass;

  double minJ = 1.0, maxStretch = 1.0;
  std::size_t inverted = 0;
  for (const Mat3 &F : body.gradients()) {
    const double J = F.determinant();
    minJ = std::min(minJ, J);
    if (J <= 0.0) ++inverted;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(F.transpose() * F, Eigen::EigenvaluesOnly);
    maxStretch = std::max(maxStretch, std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
  }

  double plastic = 0.0;
  const PointHistory &history = body.state().history;
  for (std::size_t q = 0; q < history.plasticInverse.size(); ++q)
    plastic = std::max(plastic, henckyStrain(history.allFlow(q)).norm());
  const Neighbours neighbours = countNeighbours(rest);
  Json near = {{"min", neighbours.min}, {"mean", neighbours.mean}, {"max", neighbours.max}};
  if (rest.evaluation == Evaluation::phyxels) {
    const CloudQuality quality = inspectCloud(rest);
    near["few"] = quality.few;
    near["many"] = quality.many;
    near["flat"] = quality.flat;
    near["coincident"] = quality.coincident;
    near["moment_condition"] = quality.condition;
  }
  const Simulator::Energy energy = simulator.energy(reported.id);
  return {
      {"name", body.name()},
      {"evaluation", rest.evaluation == Evaluation::stressPoints ? "stress_points" : "phyxels"},
      {"phyxels", rest.phyxelCount()},
      {"points", rest.pointCount()},
      {"components", rest.components},
      {"surfels", rest.surfels.count()},
      {"spacing_m", rest.spacing},
      {"mass_kg", mass},
      {"volume_m3", volume},
      {"mesh_volume_m3", reported.meshVolume},
      {"counted_volume_m3", rest.countedVolume},
      {"represented_part", volume > 0.0 && rest.countedVolume > 0.0 ? std::min(1.0, rest.countedVolume / volume) : 1.0},
      {"neighbours", near},
      {"stable_dt_s", body.stableStepAtRest()},
      {"integrator", nameOf(simulator.integratorOf(reported.id))},
      {"predicted_evaluations_per_s",
       {{"explicit", simulator.predictedCost(reported.id).first},
        {"implicit", simulator.predictedCost(reported.id).second}}},
      {"kernels", body.vectorised() ? kernelTarget() : "by stages"},
      {"energy_J",
       {{"kinetic", energy.kinetic},
        {"elastic", energy.elastic},
        {"stabilisation", energy.stabilisation},
        {"gravity", energy.gravity},
        {"attachment", energy.foundation},
        {"plastic", 0.0}}},
      {"momentum", json(momentum)},
      {"angular_momentum", json(angular)},
      {"centre_of_mass_m", json(centre)},
      {"min_J", minJ},
      {"max_stretch", maxStretch},
      {"error_estimate", error.relative},
      {"stabilisation_share", error.stabilisationShare},
      {"inverted_points", inverted},
      {"max_plastic_strain", plastic},
      {"deepest_penetration_m", simulator.skinDepth(reported.id)},
      {"cost_ms_per_s", 1e3 * simulator.costOf(reported.id)},
      {"asleep", simulator.asleep(reported.id)},
      {"rigid", body.rigid()},
      {"stopped", body.stopped}};
}

// What holds a body elastically where it is in the scan.
Json attachmentJson(const Simulator &simulator, std::size_t id) {
  const Body &body = *simulator.body(id);
  const ElasticFoundation &foundation = body.foundation();
  const Reaction reaction = body.foundationReaction();
  return {{"name", body.name() + "/surroundings"},
          {"bodies", {body.name(), "surroundings"}},
          {"stiffness_Pa_m", foundation.settings().stiffness},
          {"tangential_Pa_m", foundation.settings().tangential},
          {"area_m2", foundation.area()},
          {"force_N", json(reaction.force)},
          {"torque_Nm", json(reaction.torque)},
          {"centre_m", json(reaction.centre)},
          {"energy_J", simulator.energy(id).foundation}};
}

}  // namespace

std::string howComputed(const Simulator &simulator, std::size_t id) {
  const Body &body = *simulator.body(id);
  const Integrator integrator = simulator.integratorOf(id);
  const bool isExplicit = integrator == Integrator::explicitVerlet;
  const bool single = isExplicit && body.precision() == Precision::singlePrecision && !body.constitution().remembers();
  if (body.rigid()) return "rigid: it is not";
  if (!(isExplicit ? body.vectorised() : body.vectorisedTangent()))
    return std::string(nameOf(integrator)) + ", by stages";
  return std::string(nameOf(integrator)) + (single ? ", single" : ", double") + " precision, " + kernelTarget();
}

std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies) {
  Json out = {{"bodies", Json::array()},      {"probes", Json::array()},  {"reactions", Json::array()},
              {"attachments", Json::array()}, {"stages", Json::object()}, {"events", Json::array()}};
  std::vector<std::string> errors;
  for (const ReportedBody &body : bodies) {
    const ErrorEstimate error = estimateError(*simulator.body(body.id));
    errors.push_back(errorAdvice(*simulator.body(body.id), body.meshArea, error.relative));
    out["bodies"].push_back(bodyJson(simulator, body, error));
    if (simulator.body(body.id)->foundation().acts()) out["attachments"].push_back(attachmentJson(simulator, body.id));
    const std::vector<Reaction> reactions = simulator.reactions(body.id);
    for (std::size_t f = 0; f < reactions.size(); ++f)
      out["reactions"].push_back({{"fix", f < body.fixNumbers.size() ? body.fixNumbers[f] : f},
                                  {"body", simulator.body(body.id)->name()},
                                  {"force_N", json(reactions[f].force)},
                                  {"torque_Nm", json(reactions[f].torque)},
                                  {"centre_m", json(reactions[f].centre)}});
  }
  std::sort(out["reactions"].begin(), out["reactions"].end(),
            [](const Json &a, const Json &b) { return a["fix"].get<std::uint64_t>() < b["fix"].get<std::uint64_t>(); });
  // What the bodies are integrated by; with more than one of them, what the scene asks for.
  std::set<std::string> integrators;
  for (const ReportedBody &body : bodies) integrators.insert(nameOf(simulator.integratorOf(body.id)));
  out["integrator"] = integrators.size() == 1 ? *integrators.begin() : nameOf(simulator.world().integrator);
  if (simulator.quasiStatic()) out["load_factor"] = simulator.loadFactor();
  for (const Probe &probe : simulator.probes()) {
    const Simulator::ProbeState state = simulator.probeState(probe);
    out["probes"].push_back({{"name", probe.name},
                             {"reference_m", json(probe.reference)},
                             {"position_m", json(state.position)},
                             {"velocity_m_s", json(state.velocity)}});
  }
  for (const StageClock::Summary &stage : simulator.stageTimes())
    out["stages"][stage.name] = {{"median_ms", stage.median_ms}, {"p99_ms", stage.p99_ms}, {"calls", stage.calls}};
  for (const SimulationEvent &event : simulator.events())
    out["events"].push_back({{"time_s", event.time}, {"kind", event.kind}, {"text", event.text}});
  // How far off the end is, is an event of the end.
  for (const std::string &error : errors)
    if (!error.empty()) out["events"].push_back({{"time_s", simulator.time()}, {"kind", "sampling"}, {"text", error}});
  out["notices"] = noticesOf(simulator, errors);
  return out.dump();
}

}  // namespace pointbased
