// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "pointbased/cloud_quality.h"
#include "pointbased/error_estimate.h"
#include "pointbased/plasticity.h"
#include "pointbased/support_energy.h"
#include "report/advice.h"
#include "report/composition.h"

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

struct MassSums {
  Vec3 momentum = Vec3::Zero(), angularMomentum = Vec3::Zero(), centre = Vec3::Zero();
  double mass = 0.0, volume = 0.0;
};

MassSums massSums(const Body &body) {
  const RestState &rest = body.rest();
  MassSums sums;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const double m = body.restMasses()[i] + (body.supportMasses().empty() ? 0.0 : body.supportMasses()[i]);
    const Vec3 x = rest.origin + rest.positions[i] + body.state().displacements[i];
    const Vec3 &v = body.state().velocities[i];
    sums.momentum += m * v;
    sums.angularMomentum += m * x.cross(v);
    sums.centre += m * x;
    sums.mass += m;
    sums.volume += rest.volumes[i];
  }
  if (sums.mass > 0.0) sums.centre /= sums.mass;
  return sums;
}

struct Extremes {
  double minJ = 1.0, maxStretch = 1.0, plastic = 0.0;
  std::size_t inverted = 0;
};

Extremes extremesOf(const Body &body) {
  Extremes out;
  for (const Mat3 &F : body.gradients()) {
    const double J = F.determinant();
    out.minJ = std::min(out.minJ, J);
    if (J <= 0.0) ++out.inverted;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(F.transpose() * F, Eigen::EigenvaluesOnly);
    out.maxStretch = std::max(out.maxStretch, std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
  }
  const PointHistory &history = body.state().history;
  for (std::size_t q = 0; q < history.plasticInverse.size(); ++q)
    out.plastic = std::max(out.plastic, henckyStrain(history.allFlow(q)).norm());
  return out;
}

Json neighboursJson(const RestState &rest) {
  const Neighbours neighbours = countNeighbours(rest);
  Json out = {{"min", neighbours.min}, {"mean", neighbours.mean}, {"max", neighbours.max}};
  if (rest.evaluation != Evaluation::phyxels) return out;
  const CloudQuality quality = inspectCloud(rest);
  out["few"] = quality.few;
  out["many"] = quality.many;
  out["flat"] = quality.flat;
  out["coincident"] = quality.coincident;
  out["moment_condition"] = quality.condition;
  return out;
}

const char *nameOf(AccuracyStatement::Basis basis) {
  switch (basis) {
    case AccuracyStatement::Basis::verified: return "verified";
    case AccuracyStatement::Basis::estimated: return "estimated";
    case AccuracyStatement::Basis::none: break;
  }
  return "none";
}

Json json(const AccuracyStatement &statement) {
  const bool isKnown = statement.basis != AccuracyStatement::Basis::none;
  return {{"lines", statement.lines()},
          {"basis", nameOf(statement.basis)},
          {"displacement_error_m", isKnown ? Json(statement.displacement) : Json()},
          {"largest_displacement_m", statement.largestDisplacement},
          {"worst_m", statement.worst ? json(*statement.worst) : Json()},
          {"stress_error", statement.stress},
          {"left_out_part", statement.leftOut},
          {"singular_places", statement.places}};
}

Json bodyJson(const Simulator &simulator, const ReportedBody &reported, const ErrorEstimate &error) {
  const Body &body = *simulator.body(reported.id);
  const RestState &rest = body.rest();
  const MassSums sums = massSums(body);
  const Extremes extremes = extremesOf(body);
  const Diagnostics::Energy energy = simulator.diagnostics().energy(reported.id);
  return {{"name", body.name()},
          {"evaluation", rest.evaluation == Evaluation::stressPoints ? "stress_points" : "phyxels"},
          {"phyxels", rest.phyxelCount()},
          {"held_phyxels", heldPhyxels(rest)},
          {"points", rest.pointCount()},
          {"components", rest.components},
          {"surfels", rest.surfels.count()},
          {"spacing_m", rest.spacing},
          {"order", rest.stencils.quadratic.points.empty() ? "linear" : "quadratic"},
          {"mass_kg", sums.mass},
          {"added_mass_kg", body.addedMass().first},
          {"volume_m3", sums.volume},
          {"mesh_volume_m3", reported.meshVolume},
          {"counted_volume_m3", rest.countedVolume},
          {"represented_part",
           sums.volume > 0.0 && rest.countedVolume > 0.0 ? std::min(1.0, rest.countedVolume / sums.volume) : 1.0},
          {"neighbours", neighboursJson(rest)},
          {"stable_dt_s", body.stableStepAtRest()},
          {"step_s", simulator.stepper().stepSizeOf(reported.id)},
          {"integrator", nameOf(simulator.stepper().integratorOf(reported.id))},
          {"predicted_evaluations_per_s",
           {{"explicit", simulator.stepper().predictedCost(reported.id).first},
            {"implicit", simulator.stepper().predictedCost(reported.id).second}}},
          {"kernels", body.vectorised() ? kernelTarget() : "by stages"},
          {"energy_J",
           {{"kinetic", energy.kinetic},
            {"elastic", energy.elastic},
            {"stabilisation", energy.stabilisation},
            {"gravity", energy.gravity},
            {"attachment", energy.foundation},
            {"supports", supportEnergy(body)},
            {"plastic", 0.0}}},
          {"momentum", json(sums.momentum)},
          {"angular_momentum", json(sums.angularMomentum)},
          {"centre_of_mass_m", json(sums.centre)},
          {"min_J", extremes.minJ},
          {"max_stretch", extremes.maxStretch},
          {"error_estimate", error.relative},
          {"stabilisation_share", error.stabilisationShare},
          {"inverted_points", extremes.inverted},
          {"max_plastic_strain", extremes.plastic},
          {"deepest_penetration_m", simulator.diagnostics().skinDepth(reported.id)},
          {"cost_ms_per_s", 1e3 * simulator.diagnostics().costOf(reported.id)},
          {"asleep", simulator.stepper().asleep(reported.id)},
          {"rigid", body.rigid()},
          {"free", body.isFreeRigid()},
          {"stopped", body.stopMessage()}};
}

Json adaptiveJson(const AdaptiveSampling &adaptive) {
  Json out = {{"halved_cells", adaptive.halved}, {"cells", adaptive.cells}, {"error_share", adaptive.share}};
  if (!adaptive.uniform.empty()) out["uniform"] = adaptive.uniform;
  return out;
}

// Elastic support that holds a body at its position in the scan.
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
          {"torn_part", 0.0},
          {"energy_J", foundation.energy(body.state().displacements)}};
}

Json json(const ReportedAttachment &attachment) {
  const AttachmentSummary &now = attachment.now;
  return {{"name", now.name},
          {"bodies", attachment.names},
          {"stiffness_Pa_m", attachment.stiffness},
          {"tangential_Pa_m", attachment.tangential},
          {"area_m2", now.area},
          {"force_N", json(now.force)},
          {"torque_Nm", json(now.torque)},
          {"centre_m", json(now.centre)},
          {"torn_part", now.tornPart},
          {"largest_traction_Pa", now.traction},
          {"energy_J", now.energy}};
}

const char *kindOf(const AccuracyTarget &wish) {
  switch (wish.kind) {
    case AccuracyTarget::Kind::share: return "error_percent";
    case AccuracyTarget::Kind::length: return "error_mm";
    case AccuracyTarget::Kind::budget: return "budget_ms";
    case AccuracyTarget::Kind::standard: break;
  }
  return "standard";
}

Json promiseJson(const std::string &name, const AccuracyPrediction &promise) {
  Json out = {{"body", name}, {"wish", kindOf(promise.wish)}};
  if (promise.wish.kind != AccuracyTarget::Kind::standard)
    out["wished"] = promise.wish.value * (promise.wish.kind == AccuracyTarget::Kind::share ? 100.0 : 1e3);
  if (!promise.survey) {
    out["unpredicted"] = promise.unpredicted;
    return out;
  }
  const SamplingChoice &choice = promise.choice;
  out["promised_error"] = choice.error.share;
  out["band"] = {choice.error.low, choice.error.high};
  if (!promise.supposed()) {
    out["largest_displacement_m"] = choice.largest;
    out["promised_error_m"] = choice.error.share * choice.largest;
  }
  out["load"] = promise.supposed() ? "supposed" : "own";
  out["promised_ms"] = choice.frame_ms;
  out["touching_ms"] = choice.touching_ms;
  out["cost"] = promise.isMeasured ? "measured" : "predicted";
  out["spacing_m"] = choice.spacing;
  out["phyxels"] = choice.count;
  out["order"] = choice.order == LatticeOrder::quadratic ? "quadratic" : "linear";
  out["met"] = choice.unmet.empty();
  if (!choice.unmet.empty()) out["unmet"] = choice.unmet;
  return out;
}

/// The largest error of the bodies, and the sum of their times.
Json accuracyJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies) {
  Json out = {
      {"wish", Json()}, {"promised_error", 0.0}, {"band", {0.0, 0.0}}, {"promised_ms", 0.0}, {"bodies", Json::array()}};
  for (const ReportedBody &body : bodies) {
    if (!body.promise) continue;
    Json one = promiseJson(simulator.body(body.id)->name(), *body.promise);
    out["wish"] = one["wish"];
    if (one.contains("wished")) out["wished"] = one["wished"];
    if (body.promise->survey) {
      if (one["promised_error"] > out["promised_error"]) {
        out["promised_error"] = one["promised_error"];
        out["band"] = one["band"];
      }
      out["promised_ms"] = out["promised_ms"].get<double>() + body.promise->choice.frame_ms;
    }
    out["bodies"].push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::string describeComputation(const Simulator &simulator, std::size_t id) {
  const Body &body = *simulator.body(id);
  const Integrator integrator = simulator.stepper().integratorOf(id);
  const bool isExplicit = integrator == Integrator::explicitVerlet;
  const bool single = isExplicit && body.precision() == Precision::singlePrecision && !body.constitution().hasHistory();
  if (body.isStatic()) return "rigid: it is not";
  if (body.isFreeRigid())
    return "as a rigid body, explicit, steps of " + shortNumber(1e3 * simulator.stepper().stepSizeOf(id)) + " ms";
  std::string text = nameOf(integrator);
  if (!simulator.quasiStatic()) text += ", steps of " + shortNumber(1e3 * simulator.stepper().stepSizeOf(id)) + " ms";
  if (!(isExplicit ? body.vectorised() : body.vectorisedTangent())) return text + ", by stages";
  return text + (single ? ", single" : ", double") + " precision, " + kernelTarget();
}

namespace {

Json conditionsJson(const std::vector<ReportedCondition> &conditions) {
  Json out = Json::array();
  for (const ReportedCondition &one : conditions) {
    Json row{{"name", one.name},
             {"kind", one.kind},
             {"body", one.body},
             {"area_m2", one.area},
             {"force_N", json(one.force)}};
    if (one.kind == "displace") row["displacement_m"] = json(one.vector);
    if (one.kind == "force") row["set_N"] = json(one.vector);
    if (one.kind == "pressure") row["pressure_Pa"] = one.pressure;
    if (!one.warning.empty()) row["warning"] = one.warning;
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace

std::string reportJson(const Simulator &simulator, const std::vector<ReportedBody> &bodies,
                       const std::vector<ReportedTool> &tools, const std::vector<ReportedAttachment> &attachments,
                       const std::vector<ReportedGrasp> &grasps, const std::vector<ReportedCondition> &conditions,
                       const std::function<std::string(std::size_t id)> &nameOfId) {
  Json out = {{"bodies", Json::array()},      {"probes", Json::array()},  {"reactions", Json::array()},
              {"attachments", Json::array()}, {"stages", Json::object()}, {"events", Json::array()}};
  std::vector<std::string> errors, samplings;
  for (const ReportedBody &body : bodies) {
    const ErrorEstimate error = estimateError(*simulator.body(body.id));
    if (body.promise) errors.push_back(noticeOf(simulator.body(body.id)->name(), *body.promise));
    out["bodies"].push_back(bodyJson(simulator, body, error));
    if (!simulator.body(body.id)->rigid()) {
      ErrorScratch scratch;
      const AccuracyStatement statement = stateAccuracy(
          simulator, body.id, {body.meshArea, body.fixNames, body.trials.get(), body.verification, nameOfId}, scratch,
          serialFor());
      out["bodies"].back()["accuracy_statement"] = json(statement);
      if (!statement.help.empty())
        samplings.push_back("body '" + simulator.body(body.id)->name() + "': " + statement.lines()[1]);
    }
    if (body.adaptive) {
      out["bodies"].back()["adaptive"] = adaptiveJson(*body.adaptive);
      errors.push_back("body '" + simulator.body(body.id)->name() + "': " + adaptiveText(*body.adaptive));
      if (const std::string added = addedMassText(*simulator.body(body.id)); !added.empty())
        errors.back() +=
            "; inertia added to the smallest and stiffest cells for longer explicit steps, without effect at rest: " +
            added;
    }
    if (simulator.body(body.id)->foundation().acts()) out["attachments"].push_back(attachmentJson(simulator, body.id));
    const std::vector<Reaction> reactions = simulator.diagnostics().reactions(body.id);
    const std::size_t fixes = simulator.body(body.id)->rest().conditions.fixes.size();
    for (std::size_t f = 0; f < std::min(fixes, reactions.size()); ++f)
      out["reactions"].push_back({{"fix", f < body.fixNumbers.size() ? body.fixNumbers[f] : f},
                                  {"body", simulator.body(body.id)->name()},
                                  {"force_N", json(reactions[f].force)},
                                  {"torque_Nm", json(reactions[f].torque)},
                                  {"centre_m", json(reactions[f].centre)}});
  }
  std::sort(out["reactions"].begin(), out["reactions"].end(),
            [](const Json &a, const Json &b) { return a["fix"].get<std::uint64_t>() < b["fix"].get<std::uint64_t>(); });
  const bool isChosen =
      std::any_of(bodies.begin(), bodies.end(), [](const ReportedBody &b) { return b.promise != nullptr; });
  if (isChosen) out["accuracy"] = accuracyJson(simulator, bodies);
  // Integrator of the bodies; if there are several, the one requested by the scene.
  std::set<std::string> integrators;
  for (const ReportedBody &body : bodies) integrators.insert(nameOf(simulator.stepper().integratorOf(body.id)));
  out["integrator"] = integrators.size() == 1 ? *integrators.begin() : nameOf(simulator.world().settings().integrator);
  if (simulator.quasiStatic()) out["load_factor"] = simulator.loadFactor();
  for (const Probe &probe : simulator.world().probes()) {
    const World::ProbeState state = simulator.world().probeState(probe);
    out["probes"].push_back({{"name", probe.name},
                             {"reference_m", json(probe.reference)},
                             {"position_m", json(state.position)},
                             {"velocity_m_s", json(state.velocity)}});
  }
  for (const ReportedAttachment &attachment : attachments) out["attachments"].push_back(json(attachment));
  out["probe_tools"] = Json::array();
  for (const ReportedTool &tool : tools)
    out["probe_tools"].push_back({{"name", tool.name},
                                  {"position_m", json(tool.position)},
                                  {"force_N", json(tool.force)},
                                  {"depth_m", tool.depth},
                                  {"points", tool.points}});
  out["grasps"] = Json::array();
  for (const ReportedGrasp &grasp : grasps)
    out["grasps"].push_back({{"name", grasp.name},
                             {"holds", grasp.holds},
                             {"force_N", json(grasp.forces.pull)},
                             {"squeeze_N", grasp.forces.squeeze},
                             {"gap_m", grasp.forces.gap}});
  if (!conditions.empty()) out["conditions"] = conditionsJson(conditions);
  out["contacts"] = Json::array();
  for (const ContactSummary &contact : simulator.diagnostics().contacts())
    out["contacts"].push_back({{"bodies", {nameOfId(contact.first), nameOfId(contact.second)}},
                               {"force_N", json(contact.force)},
                               {"pressing_N", contact.normalForce},
                               {"depth_m", contact.depth},
                               {"points", contact.points},
                               {"area_m2", contact.area}});
  for (const StageClock::Summary &stage : simulator.diagnostics().stageTimes())
    out["stages"][stage.name] = {{"median_ms", stage.median_ms}, {"p99_ms", stage.p99_ms}, {"calls", stage.calls}};
  for (const SimulationEvent &event : simulator.diagnostics().events())
    out["events"].push_back({{"time_s", event.time}, {"kind", event.kind}, {"text", event.text}});
  // The error at the end is an event of the end.
  samplings.insert(samplings.begin(), errors.begin(), errors.end());
  for (const std::string &error : samplings)
    if (!error.empty()) out["events"].push_back({{"time_s", simulator.time()}, {"kind", "sampling"}, {"text", error}});
  out["notices"] = noticesOf(simulator, errors);
  out["composition"] = compositionJson(simulator);
  return out.dump();
}

}  // namespace pointbased
