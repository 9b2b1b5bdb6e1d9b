// SPDX-License-Identifier: Apache-2.0
// Bodies and what was measured of them; sensitivities.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/plugin_call.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/body_fit.h"
#include "c3de/session/frame_match.h"
#include "c3de/session/measured_points.h"
#include "running.h"
#include "use.h"

namespace c3de::embed {
namespace {

constexpr double kMillimetres = 1e3;  // in a metre

Result<std::vector<Vec3>> vectorsOf(const double *values, std::uint64_t count, double scale, const char *name) {
  std::vector<Vec3> out;
  if (count > 0 && values == nullptr) return refuse(C3DE_E_ARG, fmt::format("{} is null", name));
  if (count > session::kMaxMeasuredPoints)
    return refuse(C3DE_E_ARG,
                  fmt::format("{} has {} points; accepted: up to {}", name, count, session::kMaxMeasuredPoints));
  out.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    const double *v = values + 3 * i;
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      return refuse(C3DE_E_ARG,
                    fmt::format("{}[{}] is ({}, {}, {}); accepted: finite numbers", name, i, v[0], v[1], v[2]));
    out.push_back({scale * v[0], scale * v[1], scale * v[2]});
  }
  return out;
}

Result<session::MatchTargets> targetsOf(const c3de_embed_match_options &in) {
  session::MatchTargets out;
  if (in.points_file != nullptr) {
    if (in.points_n != 0) return refuse(C3DE_E_ARG, "points_m and points_file are both set; accepted: one of them");
    out.file = pathFromText(in.points_file);
    auto read = session::readMeasuredPoints(out.file, std::nullopt);
    if (!read) return refuse(read.error());
    if (const auto good = session::checkNoLandmarks(*read); !good) return refuse(good.error());
    out.surface.points_mm = std::move(read->points_mm);
    out.surface.normals = std::move(read->normals);
    return out;
  }
  out.file = "points";
  auto points = vectorsOf(in.points_m, in.points_n, kMillimetres, "points_m");
  if (!points) return tl::unexpected(points.error());
  out.surface.points_mm = std::move(*points);
  if (in.normals == nullptr) return out;
  auto normals = vectorsOf(in.normals, in.points_n, 1.0, "normals");
  if (!normals) return tl::unexpected(normals.error());
  for (Vec3 &normal : *normals) {
    const double length = norm(normal);
    if (!(length > 0.0)) return refuse(C3DE_E_ARG, "a normal is (0, 0, 0); accepted: directions");
    normal = (1.0 / length) * normal;
  }
  out.surface.normals = std::move(*normals);
  return out;
}

Result<std::vector<session::Landmark>> landmarksOf(const c3de_embed_match_options &in, const std::string &body) {
  const auto at = vectorsOf(in.landmarks_m, in.landmarks_n, 1.0, "landmarks_m");
  if (!at) return tl::unexpected(at.error());
  const auto measured = vectorsOf(in.measured_m, in.landmarks_n, kMillimetres, "measured_m");
  if (!measured) return tl::unexpected(measured.error());
  std::vector<session::Landmark> out(at->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].name = in.names != nullptr && in.names[i] != nullptr ? in.names[i] : std::to_string(i + 1);
    out[i].body = body;
    out[i].at_m = (*at)[i];
    out[i].reference_mm = kMillimetres * (*at)[i];
    out[i].target_mm = (*measured)[i];
    out[i].where = "landmark " + out[i].name;
  }
  return out;
}

Result<scene::SceneMatch> wantedOf(const c3de_embed_match_options &in, const std::string &body) {
  scene::SceneMatch out;
  out.body = body;
  const auto positive = [](double value) { return value == 0.0 || (value > 0.0 && std::isfinite(value)); };
  if (!positive(in.noise_m)) return refuse(C3DE_E_ARG, fmt::format("noise_m is {}; accepted: above 0, m", in.noise_m));
  if (!positive(in.landmark_weight))
    return refuse(C3DE_E_ARG, fmt::format("landmark_weight is {}; accepted: above 0", in.landmark_weight));
  if (in.noise_m > 0.0) out.noise_mm = kMillimetres * in.noise_m;
  if (in.landmark_weight > 0.0) out.landmarkWeight = in.landmark_weight;
  out.fitsLandmarks = (in.flags & C3DE_EMBED_MATCH_FIT) != 0;
  out.isRigidFirst = (in.flags & C3DE_EMBED_MATCH_IN_PLACE) == 0;
  out.deforms = (in.flags & C3DE_EMBED_MATCH_RIGID_ONLY) == 0;
  return out;
}

Result<session::ForceCurve> curveOf(const c3de_embed_fit_options &in) {
  session::ForceCurve out;
  if (in.curve_file != nullptr) {
    if (in.points_n != 0)
      return refuse(C3DE_E_ARG, "displacements_m and curve_file are both set; accepted: one of them");
    auto read = session::readForceCurve(pathFromText(in.curve_file));
    if (!read) return refuse(read.error());
    return std::move(*read);
  }
  if (in.points_n > 0 && (in.displacements_m == nullptr || in.forces_N == nullptr))
    return refuse(C3DE_E_ARG, "displacements_m or forces_N is null");
  if (in.points_n > session::kMaxCurvePoints)
    return refuse(C3DE_E_ARG,
                  fmt::format("the curve has {} points; accepted: up to {}", in.points_n, session::kMaxCurvePoints));
  out.displacement_m.assign(in.displacements_m, in.displacements_m + in.points_n);
  out.force_N.assign(in.forces_N, in.forces_N + in.points_n);
  out.isInMillimetres = false;
  return out;
}

/// Whether the work of a progress function continues.
c3de_status C3DE_CALL continues(void *self, double fraction, c3de_str) {
  return (*static_cast<const ProgressFn *>(self))(fraction, {}) ? C3DE_OK : C3DE_E_CANCELLED;
}

}  // namespace

Result<geometry::TriangleMesh> EmbeddedSimulation::restSkinOf(const BodyEntry &body) {
  const auto field = describe(body, C3DE_EMBED_ON_SURFACE, C3DE_SIM_FIELD_REFERENCE_POSITION);
  if (!field) return tl::unexpected(field.error());
  geometry::TriangleMesh out;
  out.vertices.resize(body.info.surface_points);
  if (out.vertices.empty())
    return refuse(C3DE_E_STATE,
                  fmt::format("body '{}' has no surface that points could be compared with", body.info.name));
  if (auto filled = fill(body, C3DE_EMBED_ON_SURFACE, **field, out.vertices.front().data(), out.vertices.size());
      !filled)
    return tl::unexpected(filled.error());
  for (Vec3 &x : out.vertices) x = kMillimetres * x;
  const auto triangles = trianglesOf(body);
  if (!triangles) return tl::unexpected(triangles.error());
  out.triangles.resize(triangles->shape[0]);
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    std::memcpy(out.triangles[t].data(),
                static_cast<const char *>(triangles->data) + static_cast<std::int64_t>(t) * triangles->strides[0],
                sizeof out.triangles[t]);
    for (const std::uint32_t corner : out.triangles[t])
      if (corner >= out.vertices.size())
        return refuse(C3DE_E_INTERNAL, "a triangle of the simulator has a corner that does not exist");
  }
  return out;
}

Result<const char *> EmbeddedSimulation::match(std::uint64_t index, const c3de_embed_match_options &in,
                                               const ProgressFn &shown) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto entry = entryOf(index);
  if (!entry) return tl::unexpected(entry.error());
  const BodyEntry body = **entry;
  session::FrameRequest request;
  auto wanted = wantedOf(in, body.info.name);
  if (!wanted) return tl::unexpected(wanted.error());
  request.wanted = std::move(*wanted);
  auto targets = targetsOf(in);
  if (!targets) return tl::unexpected(targets.error());
  request.targets = std::move(*targets);
  auto landmarks = landmarksOf(in, body.info.name);
  if (!landmarks) return tl::unexpected(landmarks.error());
  request.landmarks = std::move(*landmarks);
  const auto skin = restSkinOf(body);
  if (!skin) return tl::unexpected(skin.error());
  const auto table = session::matchingTable(simulator_->get());
  if (!table) return refuse(table.error());
  if (request.wanted.deforms && *table == nullptr)
    return refuse(C3DE_E_UNSUPPORTED, fmt::format("simulator {} does not match bodies", identity_.classId));
  const bool continues = (in.flags & C3DE_EMBED_MATCH_CONTINUE) != 0;
  if (continues && request.wanted.deforms && lastMatch_ && lastMatch_->body == index &&
      lastMatch_->isRigidFirst == request.wanted.isRigidFirst)
    request.measuredFromBodyBefore = lastMatch_->measuredFromBody;
  lastMatch_.reset();
  const Running running(*this);
  const auto found = session::matchFrame(*session_, simulator_->get(), *scene_, body.info.name, *skin, request,
                                         running.progress(shown));
  stateChanged();
  if (!found) return refuse(found.error());
  if (found->canContinue()) lastMatch_ = LastMatch{index, request.wanted.isRigidFirst, found->measuredFromBody()};
  if (auto read = readStatus(); !read) return tl::unexpected(read.error());
  inverse_ = session::matchJson(found->rigid, found->elastic);
  return inverse_.c_str();
}

Result<const char *> EmbeddedSimulation::fit(std::uint64_t index, const c3de_embed_fit_options &in,
                                             const ProgressFn &shown) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto entry = entryOf(index);
  if (!entry) return tl::unexpected(entry.error());
  const std::string name = (*entry)->info.name;
  if (!(in.noise >= 0.0) || !std::isfinite(in.noise))
    return refuse(C3DE_E_ARG, fmt::format("noise is {}; accepted: 0 or more", in.noise));
  const auto curve = curveOf(in);
  if (!curve) return tl::unexpected(curve.error());
  session::BodyFitOptions how;
  how.noise = in.noise;
  if ((in.flags & C3DE_EMBED_FIT_WATCHED) != 0) how.watched_m = Vec3{in.watched_m[0], in.watched_m[1], in.watched_m[2]};
  const Running running(*this);
  const auto begin = std::chrono::steady_clock::now();
  const auto found = session::fitBody(
      simulator_->get(), name, *curve, how, session_->plugins().ownerOf(simulator_->get()),
      [this] { return session_->plugins().takeError(); }, running.progress(shown));
  if (!found) return refuse(found.error());
  session::FitFacts facts{name, in.curve_file != nullptr ? in.curve_file : "curve", in.noise, 0.0};
  facts.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  inverse_ = session::fitJson(*found, *curve, facts);
  return inverse_.c_str();
}

Result<const char *> EmbeddedSimulation::sensitivity(std::uint64_t index, const double *objective, std::uint64_t points,
                                                     double *forces) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto entry = entryOf(index);
  if (!entry) return tl::unexpected(entry.error());
  if (points != (*entry)->info.points)
    return refuse(C3DE_E_ARG, fmt::format("points_n is {}; accepted: {}, the points of body '{}'", points,
                                          (*entry)->info.points, (*entry)->info.name));
  const auto table = session::identificationTable(simulator_->get());
  if (!table) return refuse(table.error());
  if (*table == nullptr)
    return refuse(C3DE_E_UNSUPPORTED,
                  fmt::format("simulator {} does not differentiate its solutions", identity_.classId));
  c3de_sensitivity_request request{};
  request.size = sizeof request;
  request.body = (*entry)->handle;
  request.objective = objective;
  request.points_n = points;
  const Running running(*this);
  ProgressFn wanted = running.progress({});
  const c3de_progress progress{sizeof(c3de_progress), 0, &wanted, &continues};
  std::string text;
  const c3de_status code = callPluginFunction(
      session_->plugins().ownerOf(simulator_->get()), "a sensitivity", CallKind::step,
      [&] { return (*table)->sensitivity(simulator_->get(), &request, &progress, forces, scene::sinkInto(text)); });
  if (code == C3DE_E_CANCELLED) return refuse(C3DE_E_CANCELLED, "the sensitivity was cancelled");
  if (code < 0) return tl::unexpected(reason("the sensitivity", code));
  inverse_ = std::move(text);
  return inverse_.c_str();
}

}  // namespace c3de::embed
