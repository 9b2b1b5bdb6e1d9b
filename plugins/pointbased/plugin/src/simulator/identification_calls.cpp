// SPDX-License-Identifier: Apache-2.0
#include "simulator/identification_calls.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/build_request.h"
#include "c3de/sdk/identification.hpp"
#include "pointbased/equilibrium_sensitivity.h"
#include "pointbased/stiffness_fit.h"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

namespace {

std::vector<CurvePoint> curveOf(const c3de_fit_request &in) {
  std::vector<CurvePoint> out(static_cast<std::size_t>(in.points_n));
  if (out.empty()) return out;
  (void)sdk::notNull(in.displacements_m, "displacements_m");
  (void)sdk::notNull(in.forces_N, "forces_N");
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {in.displacements_m[i], in.forces_N[i]};
  return out;
}

/// What acts on the body and is not part of a fit. Throws sdk::Error.
void checkAlone(const SimulatorParts &parts, std::uint64_t id, const BodyRecord &record, const Body &body) {
  const SimulatedWorld &world = parts.world;
  const auto refuse = [&](const std::string &what) { throw Error(C3DE_E_STATE, "body '" + record.name + "' " + what); };
  if (body.rigid()) refuse("is rigid and has no stiffness");
  if (!body.liveSupports().empty()) refuse("has supports that were set by hand; accepted: those of the scene");
  const std::vector<SavedLoad> loads = parts.forces.saved();
  const bool isLoaded =
      std::any_of(loads.begin(), loads.end(), [&](const SavedLoad &load) { return load.body == record.identity(); });
  if (isLoaded || !body.externalForces().empty())
    refuse("has loads that were set by hand; accepted: those of the scene");
  const std::vector<SavedMatch> matches = parts.forces.savedMatches();
  if (std::any_of(matches.begin(), matches.end(),
                  [&](const SavedMatch &match) { return match.body == record.identity(); }))
    refuse("has the forces of a match; reset the simulation first");
  if (!world.table.attachmentsOf(id).empty()) refuse("is attached to others, which a fit does not contain");
  if (body.constitution().plastic()) refuse("flows plastically; accepted: an elastic material");
  if (body.rereferenceCount() > 0) refuse("has flowed; reset the simulation first");
  if (!world.table.obstacles().empty() || world.simulator.world().settings().box.enabled)
    refuse("may touch obstacles or walls; a fit contains no contact, so remove them from the scene");
  for (const auto &[other, otherRecord] : world.table.bodies())
    if (other != id && world.simulator.world().canTouch(id, other))
      refuse("may touch body '" + otherRecord.name +
             "'; a fit contains no contact, so disable that of the pair, or remove the body");
}

/// Name of a material of a body, by its number: that of the body, then those of its parts. Unique within the body.
std::string nameOfMaterial(const BodySource &source, const std::string &body, std::size_t material) {
  if (material == 0 || material > source.parts.size()) return body;
  const std::string &name = source.parts[material - 1].name;
  const bool isUnique =
      std::count_if(source.parts.begin(), source.parts.end(), [&](const auto &part) { return part.name == name; }) == 1;
  return name.empty() || name == body || !isUnique ? body + ".parts." + std::to_string(material - 1) : name;
}

nlohmann::json orNull(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

std::string jsonOf(const StiffnessFit &fit, const BodySource &source, const std::string &body) {
  nlohmann::json moduli = nlohmann::json::array();
  for (std::size_t m = 0; m < fit.moduli.size(); ++m) {
    const FittedModulus &one = fit.moduli[m];
    moduli.push_back({{"material", nameOfMaterial(source, body, m)},
                      {"value_Pa", one.value},
                      {"low_Pa", one.low},
                      {"high_Pa", orNull(one.high)},
                      {"own", one.isOwn}});
  }
  return nlohmann::json{{"reason", fit.reason}, {"moduli", moduli}, {"predicted", fit.predicted}}.dump();
}

void putJson(c3de_sink json, const std::string &text) {
  if (const c3de_status status = sdk::put(json, text); status < 0) throw Error(status, "the text was not accepted");
}

nlohmann::json jsonOf(const Vec3 &v) { return {v[0], v[1], v[2]}; }

std::string jsonOf(const EquilibriumSensitivity &found, const BodySource &source, const std::string &body) {
  nlohmann::json supports = nlohmann::json::array(), moduli = nlohmann::json::array();
  for (std::size_t f = 0; f < std::min(found.supports.size(), source.fixNumbers.size()); ++f)
    supports.push_back({{"fix", source.fixNumbers[f]},
                        {"displacement", jsonOf(found.supports[f].displacement)},
                        {"rotation", jsonOf(found.supports[f].rotation)},
                        {"centre_m", jsonOf(found.supports[f].centre)}});
  for (std::size_t m = 0; m < found.youngsModuli.size(); ++m)
    moduli.push_back({{"material", nameOfMaterial(source, body, m)}, {"value", orNull(found.youngsModuli[m])}});
  return nlohmann::json{
      {"supports", supports},
      {"foundation", {{"stiffness", found.foundationStiffness}, {"tangential", found.foundationTangential}}},
      {"moduli", moduli}}
      .dump();
}

}  // namespace

void IdentificationCalls::fit(const c3de_fit_request *request, const c3de_progress *progress, c3de_fit_result *out,
                              c3de_sink json) {
  const c3de_fit_request in = sdk::readStruct(request, "request");
  const std::vector<CurvePoint> curve = curveOf(in);
  StiffnessModel model;
  BodySource source;
  std::string name;
  {
    const std::lock_guard lock(parts_.world.mutex);
    const BodyRecord &record = parts_.world.table.bodyOrThrow(in.body.v);
    const Body &body = *parts_.world.simulator.body(in.body.v);
    checkAlone(parts_, in.body.v, record, body);
    if ((in.flags & C3DE_FIT_WATCHED) != 0) {
      model.watchedPoint = Vec3(in.watched_m);
      record.checkNearBody(parts_.world.context.services, *model.watchedPoint, body.rest().spacing,
                           "the measured point ");
    }
    model.rest = body.sharedRest();
    model.constitution = body.constitution();
    model.foundation = body.foundation().settings();
    model.foundation.retardationTime = 0.0;
    model.gravity = parts_.world.simulator.world().settings().gravity;
    source = record.source;
    name = record.name;
  }
  const sdk::Progress wanted(progress);
  BuildRequest stop(wanted);
  StiffnessFitSettings settings;
  settings.noise = in.noise;
  if (in.iterations > 0) settings.maxIterations = static_cast<int>(std::min(in.iterations, 1000u));
  settings.stop = &stop;
  settings.progress = [&stop](double fraction) { return stop.report(fraction, "solving along the curve"); };
  const auto found = fitStiffness(model, curve, parts_.world.context.services.parallelFor(), settings);
  if (!found) {
    if (found.error() == "cancelled") throw Error(C3DE_E_CANCELLED, "cancelled");
    throw Error(C3DE_E_STATE, "body '" + name + "': " + found.error());
  }
  c3de_fit_result result{};
  result.flags =
      (found->hasConverged ? C3DE_FIT_CONVERGED : 0u) | (found->control == CurveControl::load ? C3DE_FIT_LOADED : 0u);
  result.verdict = static_cast<std::uint32_t>(found->verdict);
  result.iterations = static_cast<std::uint32_t>(found->iterations);
  result.solutions = found->solutions;
  result.residual = found->residual;
  result.measured = found->measured;
  sdk::writeStruct(out, result, "out");
  putJson(json, jsonOf(*found, source, name));
}

void IdentificationCalls::sensitivity(const c3de_sensitivity_request *request, const c3de_progress *progress,
                                      double *forces, c3de_sink json) {
  const c3de_sensitivity_request in = sdk::readStruct(request, "request");
  const StateLock lock(parts_.world);
  const BodyRecord &record = parts_.world.table.bodyOrThrow(in.body.v);
  Body &body = *parts_.world.simulator.body(in.body.v);
  const std::size_t n = body.rest().phyxelCount();
  if (in.points_n != n)
    throw Error(C3DE_E_ARG, "points_n is " + std::to_string(in.points_n) + "; accepted: " + std::to_string(n) +
                                ", the points of body '" + record.name + "'");
  (void)sdk::notNull(in.objective, "objective");
  (void)sdk::notNull(forces, "forces");
  if (!parts_.world.simulator.quasiStatic())
    throw Error(C3DE_E_STATE,
                "the solution is not static; accepted: a scene with integrator = \"quasistatic\", after its steps");
  std::vector<Vec3> objective(n);
  for (std::size_t i = 0; i < n; ++i) objective[i] = Vec3(in.objective + 3 * i);
  const ParallelFor parallelFor = parts_.world.context.services.parallelFor();
  const WorldSettings &settings = parts_.world.simulator.world().settings();
  Environment environment;
  environment.gravity = settings.gravity;
  environment.obstacles = parts_.world.simulator.world().obstaclesOf(in.body.v);
  environment.box = parts_.world.simulator.world().boxOf(in.body.v);
  environment.tolerance = settings.tolerance;
  environment.preconditioner = settings.preconditioner;
  environment.parallelFor = &parallelFor;
  const sdk::Progress wanted(progress);
  BuildRequest stop(wanted);
  environment.stop = &stop;
  const auto found = [&] {
    try {
      EquilibriumSensitivitySolver solver;
      return solver.solve(body, environment, parts_.world.simulator.loadFactor(), objective);
    } catch (const Stopped &) {
      throw Error(C3DE_E_CANCELLED, "cancelled");
    }
  }();
  if (!found) throw Error(C3DE_E_STATE, found.error());
  for (std::size_t i = 0; i < n; ++i) std::copy_n(found->forces[i].data(), 3, forces + 3 * i);
  putJson(json, jsonOf(*found, record.source, record.name));
}

}  // namespace pointbased
