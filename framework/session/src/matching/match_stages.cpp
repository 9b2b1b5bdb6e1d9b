// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/match_stages.h"

#include <charconv>
#include <chrono>

#include "c3de/collision/aabb_tree.h"
#include "c3de/core/text.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/session/body_match.h"
#include "c3de/session/body_states.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

/// Positions minus displacements.
geometry::TriangleMesh atRest(const BodyState &state) {
  geometry::TriangleMesh rest = state.skin;
  for (const geometry::PointArray &array : state.skinArrays) {
    if (array.name != "displacement [mm]") continue;
    for (std::size_t i = 0; i < rest.vertices.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a) rest.vertices[i][a] -= array.values[3 * i + a];
  }
  return rest;
}

}  // namespace

Expected<void> setMatchLabel(const std::string &text, scene::SceneMatch &match) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  match.labels.label.reset();
  match.labels.labelName.clear();
  if (error != std::errc() || end != text.data() + text.size()) {
    match.labels.labelName = text;
    return {};
  }
  if (number == 0 || number > 65535)
    return fail(ErrorCode::usage, "the label is " + text + "; accepted: a number from 1 to 65535, or a name");
  match.labels.label = static_cast<std::uint16_t>(number);
  return {};
}

std::string nameInSimulator(const scene::SceneFile &scene, const std::string &name) {
  for (const scene::SceneBody &body : scene.bodies)
    if (!body.volume.slides.empty() && scene::nameOfRest(body) == name) return body.name;
  return name;
}

std::vector<std::string> simulatedBodies(c3de_object *simulator) {
  std::vector<std::string> names;
  const auto table = simulatorTable(simulator);
  if (!table) return names;
  c3de_handle handle{};
  c3de_sim_body_info info{};
  info.size = sizeof info;
  for (std::uint64_t i = 0; (*table)->body_at(simulator, i, &handle) >= 0; ++i)
    if ((*table)->body_info(simulator, handle, &info) >= 0) names.push_back(displayText(fromAbi(info.name)));
  return names;
}

Expected<BodySkins> skinsOf(c3de_object *simulator, const std::string &body,
                            const std::function<std::string()> &takeError) {
  auto states = readBodyStates(simulator, BodyParts::skin, takeError);
  if (!states) return tl::unexpected(states.error());
  for (BodyState &state : *states) {
    if (state.name != body) continue;
    if (!state.skin.triangles.empty()) return BodySkins{atRest(state), std::move(state.skin)};
    return fail(ErrorCode::plugin, "the simulator has no skin for body '" + body + "'");
  }
  return fail(ErrorCode::plugin, "the simulator has no body '" + body + "'");
}

std::vector<Landmark> withTargets(const std::vector<Landmark> &landmarks) {
  std::vector<Landmark> out;
  for (const Landmark &one : landmarks)
    if (one.target_mm) out.push_back(one);
  return out;
}

Expected<std::vector<Landmark>> landmarksOfBody(c3de_object *simulator, const scene::SceneFile &scene,
                                                const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                                const std::string &body,
                                                const std::function<std::string()> &takeError) {
  std::vector<Landmark> out = withTargets(landmarks);
  if (out.empty()) return out;
  if (const auto found = findBodies(simulator, scene, out, takeError); !found) return tl::unexpected(found.error());
  std::erase_if(out, [&](const Landmark &one) { return !one.body.empty() && one.body != body; });
  if (out.empty() && match.fitsLandmarks)
    return fail(ErrorCode::usage, "no landmark of body '" + body +
                                      "' has a measured position that could be fitted; accepted: target landmarks of "
                                      "this body");
  return out;
}

Expected<RigidMatch> findMotion(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                ThreadPool *pool, const ProgressFn &progress) {
  if (!match.isRigidFirst) return matchInPlace(skin, targets, landmarks, match, pool);
  auto rigid = matchRigid(skin, targets, landmarks, match, pool, progress);
  if (!match.deforms) return rigid;
  scene::SceneMatch wider = match;
  for (const double factor : {2.0, 5.0, 10.0}) {
    if (!rigid || rigid->rigid.verdict != registration::RegistrationVerdict::unexplained) break;
    wider.noise_mm = factor * match.noise_mm;
    auto next = matchRigid(skin, targets, landmarks, wider, pool, progress);
    if (!next && next.error().code == ErrorCode::cancelled) return next;
    if (!next || !next->isUsable()) break;
    rigid = std::move(next);
  }
  return rigid;
}

Expected<ElasticMatch> deformBody(c3de_object *simulator, const std::string &body, const RigidMatch &rigid,
                                  const MatchTargets &targets, const std::vector<Landmark> &landmarks,
                                  const scene::SceneMatch &match, const char *owner,
                                  const std::function<std::string()> &takeError, const ProgressFn &progress,
                                  DeformationOptions options) {
  const auto begin = std::chrono::steady_clock::now();
  registration::MeasuredSurface measured = targets.surface;
  if (match.fitsLandmarks)
    for (const Landmark &one : landmarks)
      if (one.target_mm) measured.pairs.push_back({one.reference_mm, *one.target_mm});
  BodyMatchOptions how;
  how.measuredFromBody = rigid.rigid.measuredFromBody;
  how.isMotionKnown = !match.isRigidFirst;
  how.continuesLast = options.continuesLast;
  how.showsIterations = options.showsIterations;
  how.noise_mm = match.noise_mm;
  auto found = matchBody(simulator, body, measured, how, owner, takeError, progress);
  ElasticMatch out;
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (found)
    out.body = std::move(*found);
  else if (found.error().code == ErrorCode::cancelled)
    return tl::unexpected(found.error());
  else
    out.failure = found.error().message;
  return out;
}

Expected<void> measureLandmarks(c3de_object *simulator, const std::vector<Landmark> &landmarks, const RigidMatch &rigid,
                                const std::function<std::string()> &takeError, ElasticMatch &elastic) {
  if (!elastic.body || landmarks.empty()) return {};
  // Without a scene: its distances and angles may be of other landmarks.
  const auto now = measure(simulator, scene::SceneFile(), landmarks, takeError);
  if (!now) return tl::unexpected(now.error());
  std::vector<Vec3> at_mm;
  for (const MeasuredLandmark &one : now->landmarks) at_mm.push_back(one.position_mm);
  addLandmarks(rigid, std::move(at_mm), elastic);
  return {};
}

std::string failureOf(const RigidMatch &match) {
  std::string text = match.rigid.verdict == registration::RegistrationVerdict::refused
                         ? "no rigid motion is credible"
                         : "the rigid motion is ambiguous";
  for (const std::string &warning : match.rigid.warnings) text += "; " + warning;
  return text;
}

Expected<std::vector<MatchedPoint>> matchedPoints(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                                  const RigidMatch &rigid, const ElasticMatch &elastic,
                                                  const Mat4 &motion) {
  const auto tree = collision::AabbTree::build(skin.vertices, skin.triangles);
  if (!tree) return tl::unexpected(tree.error());
  const Mat4 bodyFromMeasured = geometry::rigidInverse(motion);
  std::vector<MatchedPoint> out;
  for (std::size_t i = 0; i < targets.surface.points_mm.size(); ++i) {
    MatchedPoint one;
    one.measured_mm = transformPoint(bodyFromMeasured, targets.surface.points_mm[i]);
    one.surface_mm = tree->closest(one.measured_mm).point;
    one.isUsed = elastic.body ? i < elastic.body->weights.size() && elastic.body->weights[i] > 0.5
                              : one.distance_mm() <= rigid.rigid.after.limit_mm;
    out.push_back(one);
  }
  return out;
}

}  // namespace c3de::session
