// SPDX-License-Identifier: Apache-2.0
#include "simulator/matching_calls.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/build_request.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/matching.hpp"
#include "pointbased/surface_match.h"
#include "pointbased/surfels.h"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

/// What of the body a match depends on, at the beginning of the match.
struct MatchedBody {
  ObjectName name;
  std::shared_ptr<const RestState> rest;
  Constitution constitution;
  Foundation foundation;
  bool hasOwnSupport = true;  ///< otherwise the springs of the request are added
};

namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Vec3 vectorAt(const double *numbers, std::uint64_t i) { return Vec3(numbers + 3 * i); }

MatchMotion motionOf(const c3de_match_motion &in) {
  MatchMotion out;
  out.rotation = Eigen::Map<const RowMajor>(in.rotation);
  out.translation = Vec3(in.translation_m);
  requireRotation(out.rotation);
  requireFinite("the translation of the motion", out.translation);
  return out;
}

c3de_match_motion motionOf(const MatchMotion &in) {
  c3de_match_motion out{};
  Eigen::Map<RowMajor>(out.rotation) = in.rotation;
  std::copy_n(in.translation.data(), 3, out.translation_m);
  return out;
}

std::vector<MatchPoint> pointsOf(const c3de_match_request &in) {
  if (in.points_n > 0) (void)sdk::notNull(in.points_m, "points_m");
  std::vector<MatchPoint> out(static_cast<std::size_t>(in.points_n));
  for (std::uint64_t i = 0; i < in.points_n; ++i) {
    out[i].position = vectorAt(in.points_m, i);
    if (in.normals) out[i].normal = vectorAt(in.normals, i);
  }
  return out;
}

std::vector<MatchLandmark> landmarksOf(const c3de_match_request &in) {
  std::vector<MatchLandmark> out;
  if (in.landmarks_n > 0) (void)sdk::notNull(in.landmarks, "landmarks");
  for (std::uint64_t i = 0; i < in.landmarks_n; ++i) {
    const c3de_match_landmark one = sdk::readElement(in.landmarks, i, in.landmarks_stride, "landmark");
    out.push_back({Vec3(one.reference_m), Vec3(one.measured_m), one.noise_m});
  }
  return out;
}

bool areEqual(const Material &a, const Material &b) {
  return a.law == b.law && a.youngsModulus == b.youngsModulus && a.poissonRatio == b.poissonRatio &&
         a.restDensity == b.restDensity && a.volumeStiffness == b.volumeStiffness && a.custom == b.custom;
}

/// Whether a match of one body can start from the solution of the other.
bool areEqual(const MatchedBody &a, const MatchedBody &b) {
  const std::vector<Material> &one = a.constitution.materials, &other = b.constitution.materials;
  return a.rest == b.rest && a.constitution.stabilisation == b.constitution.stabilisation &&
         a.foundation.stiffness == b.foundation.stiffness && a.foundation.tangential == b.foundation.tangential &&
         std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const Material &x, const Material &y) { return areEqual(x, y); });
}

double rootMeanSquare(const std::vector<double> &values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

c3de_match_result resultOf(const SurfaceMatchResult &found) {
  c3de_match_result out{};
  out.flags =
      (found.hasConverged ? C3DE_MATCH_CONVERGED : 0u) | (found.expectedErrors.empty() ? 0u : C3DE_MATCH_ERROR_KNOWN);
  out.iterations = static_cast<std::uint32_t>(found.iterations);
  out.motion = motionOf(found.motion);
  out.rigid = motionOf(found.rigid);
  out.before_m = found.distanceAtStart;
  out.rigid_m = found.distanceRigid;
  out.after_m = found.distance;
  out.used_part = std::min(1.0, found.usedPart);
  for (const Vec3 &force : found.forces) out.force_N += force.norm();
  out.error_m = rootMeanSquare(found.expectedErrors);
  for (const double error : found.expectedErrors) out.largest_error_m = std::max(out.largest_error_m, error);
  for (const std::uint8_t one : found.isUnknown) out.unknown_part += one != 0 ? 1.0 : 0.0;
  if (!found.isUnknown.empty()) out.unknown_part /= static_cast<double>(found.isUnknown.size());
  return out;
}

/// Expected errors at the points of the skin, m; null where the measurement says hardly anything.
nlohmann::json skinErrorsOf(const SurfaceMatchResult &found, const RestState &rest, const ParallelFor &parallelFor) {
  const std::vector<double> isUnknown(found.isUnknown.begin(), found.isUnknown.end());
  std::vector<double> errors(rest.surfels.count()), unknownPart(errors.size());
  interpolateScalars(rest.surfels, found.expectedErrors, errors, parallelFor);
  interpolateScalars(rest.surfels, isUnknown, unknownPart, parallelFor);
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t s = 0; s < errors.size(); ++s)
    out.push_back(unknownPart[s] > 0.5 ? nlohmann::json() : nlohmann::json(std::max(0.0, errors[s])));
  return out;
}

std::string jsonOf(const SurfaceMatchResult &found, const RestState &rest, const ParallelFor &parallelFor) {
  nlohmann::json points = nlohmann::json::array(), landmarks = nlohmann::json::array();
  for (std::size_t i = 0; i < found.distances.size(); ++i) {
    nlohmann::json one{{"weight", found.weights[i]}};
    // No part of the skin faces some points.
    if (std::isfinite(found.distances[i])) one["distance_m"] = found.distances[i];
    points.push_back(std::move(one));
  }
  for (const double error : found.landmarkErrors) landmarks.push_back({{"error_m", error}});
  nlohmann::json all{{"points", points}, {"landmarks", landmarks}};
  if (!found.expectedErrors.empty()) all["skin_error_m"] = skinErrorsOf(found, rest, parallelFor);
  return all.dump();
}

/// Shows the iterations of a match while the simulation is not stepped. The destructor restores the state.
class ShownIterations {
 public:
  ShownIterations(SimulatedWorld &world, std::uint64_t body, std::shared_ptr<const RestState> rest)
      : world_(world), body_(body), rest_(std::move(rest)) {
    const std::lock_guard lock(world_.mutex);
    steps_ = world_.simulator.steps();
    resets_ = world_.resets;
  }
  ~ShownIterations() { const StateLock lock(world_); }
  ShownIterations(const ShownIterations &) = delete;
  ShownIterations &operator=(const ShownIterations &) = delete;

  void show(std::span<const Vec3> displacements) {
    const std::lock_guard lock(world_.mutex);
    const Body *body = world_.simulator.body(body_);
    if (body && body->sharedRest() == rest_ && world_.simulator.steps() == steps_ && world_.resets == resets_)
      world_.show(body_, displacements);
  }

 private:
  SimulatedWorld &world_;
  std::uint64_t body_, steps_ = 0, resets_ = 0;
  std::shared_ptr<const RestState> rest_;
};

}  // namespace

struct MatchingCalls::Kept {
  MatchedBody body;
  SurfaceMatch solver;
};

MatchingCalls::MatchingCalls(SimulatorParts &parts) : parts_(parts) {}
MatchingCalls::~MatchingCalls() = default;

void MatchingCalls::match(const c3de_match_request *request, const c3de_progress *progress, c3de_match_result *out,
                          c3de_sink json) {
  const c3de_match_request in = sdk::readStruct(request, "request");
  SimulatedWorld &world = parts_.world;
  const auto read = [&] {
    const std::lock_guard lock(world.mutex);
    const BodyRecord &record = world.table.bodyOrThrow(in.body.v);
    const Body &body = *world.simulator.body(in.body.v);
    if (body.rigid()) throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid, so it cannot be deformed");
    if (!body.liveSupports().empty())
      throw Error(C3DE_E_STATE, "body '" + record.name + "' has supports that were set by hand; remove them first");
    MatchedBody found{record.identity(), body.sharedRest(), body.constitution(), body.foundation().settings()};
    found.hasOwnSupport = found.foundation.holds() || !body.rest().conditions.held.empty();
    if (!found.hasOwnSupport) found.foundation.stiffness = found.foundation.tangential = in.support_Pa_m;
    found.foundation.retardationTime = 0.0;
    return found;
  };
  const MatchedBody matched = read();
  const sdk::Progress wanted(progress);
  BuildRequest stop(wanted);
  const ParallelFor parallelFor = world.context.services.parallelFor();
  const auto checked = [](auto result) {
    if (result) return std::move(*result);
    const bool isCancelled = result.error() == "cancelled";
    throw Error(isCancelled ? C3DE_E_CANCELLED : C3DE_E_STATE, result.error());
  };
  if (!stop.report(0.0, "computing responses of the body")) throw Error(C3DE_E_CANCELLED, "cancelled");
  std::unique_ptr<Kept> kept;
  {
    const std::lock_guard lock(keptMutex_);
    kept = std::move(kept_);
  }
  if ((in.flags & C3DE_MATCH_CONTINUE) == 0 || !kept || !areEqual(kept->body, matched))
    kept = std::make_unique<Kept>(Kept{matched, checked(SurfaceMatch::create(matched.rest, matched.constitution,
                                                                             matched.foundation, parallelFor, &stop))});
  SurfaceMatchSettings settings;
  settings.noise = in.noise_m;
  settings.start = motionOf(in.motion);
  settings.isMotionKnown = (in.flags & C3DE_MATCH_MOTION_KNOWN) != 0;
  if (in.iterations > 0) settings.maxIterations = static_cast<int>(std::min(in.iterations, 1000u));
  settings.stop = &stop;
  std::optional<ShownIterations> shown;
  if ((in.flags & C3DE_MATCH_SHOW) != 0) shown.emplace(world, in.body.v, matched.rest);
  settings.progress = [&](const SurfaceMatchProgress &now) {
    if (shown) shown->show(now.displacements);
    return stop.report(0.5 + 0.5 * now.iteration / std::max(1, now.maxIterations),
                       "distance " + shortNumber(1e3 * now.distance) + " mm");
  };
  SurfaceMatchResult found = checked(kept->solver.match(pointsOf(in), landmarksOf(in), settings));
  shown.reset();
  sdk::writeStruct(out, resultOf(found), "out");
  if (const c3de_status status = sdk::put(json, jsonOf(found, *matched.rest, parallelFor)); status < 0)
    throw Error(status, "the text was not accepted");
  if (!areEqual(matched, read()))
    throw Error(C3DE_E_STATE, "the body was changed while it was matched; match it again");
  // The match is relative to the body at rest, on which gravity does not act.
  {
    const std::lock_guard lock(world.mutex);
    (void)world.table.bodyOrThrow(in.body.v);
    const Vec3 gravity = world.simulator.world().settings().gravity;
    const std::span<const double> weights = world.simulator.body(in.body.v)->weights();
    if (!gravity.isZero(0.0))
      for (std::size_t i = 0; i < std::min(weights.size(), found.forces.size()); ++i)
        found.forces[i] -= weights[i] * gravity;
  }
  // A body that nothing held keeps the springs of the match, otherwise it could move freely with its forces.
  if (!matched.hasOwnSupport)
    for (const char *id : {C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS, "surroundings.tangential"})
      (void)parts_.changes.make(SetBodyParameter{matched.name, ParameterEntry(sdk::numberValue(id, in.support_Pa_m))});
  (void)parts_.changes.make(SetMatchedState{matched.name, found.displacements, found.forces});
  const std::lock_guard lock(keptMutex_);
  kept_ = std::move(kept);
}

}  // namespace pointbased
