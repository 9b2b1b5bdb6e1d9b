// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_match.h"

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/simulator_access.h"
#include "loading/part_progress.h"

namespace c3de {

template <>
struct TableSlots<c3de_matching_v0> {
  using Table = c3de_matching_v0;
  static constexpr const char *name = C3DE_IFACE_MATCHING_ID;
  static constexpr std::array slots = {TableSlot{"match", offsetof(Table, match), 1}};
};

}  // namespace c3de

namespace c3de::session {
namespace {

using Json = nlohmann::json;

constexpr double kMetresPerMillimetre = 1e-3;
constexpr double kPascalsPerMetre = 1e6;  // in one kPa/mm

c3de_match_motion motionOf(const Mat4 &measuredFromBody) {
  c3de_match_motion out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      out.rotation[3 * row + column] = measuredFromBody[4 * column + row];
    out.translation_m[row] = kMetresPerMillimetre * measuredFromBody[12 + row];
  }
  return out;
}

Mat4 matrixOf(const c3de_match_motion &motion) {
  Mat4 out = kIdentity4;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) out[4 * column + row] = motion.rotation[3 * row + column];
    out[12 + row] = motion.translation_m[row] / kMetresPerMillimetre;
  }
  return out;
}

std::vector<double> metres(const std::vector<Vec3> &points_mm) {
  std::vector<double> out;
  for (const Vec3 &point : points_mm)
    for (const double coordinate : point) out.push_back(kMetresPerMillimetre * coordinate);
  return out;
}

/// Normals of unknown direction are not used: they would exclude the side that faces a point.
std::vector<double> orientedNormals(const registration::MeasuredSurface &measured) {
  std::vector<double> out;
  if (measured.areNormalsOriented)
    for (const Vec3 &normal : measured.normals) out.insert(out.end(), normal.begin(), normal.end());
  return out;
}

std::vector<c3de_match_landmark> landmarksOf(const registration::MeasuredSurface &measured) {
  std::vector<c3de_match_landmark> out;
  for (const registration::LandmarkPair &pair : measured.pairs) {
    c3de_match_landmark one{};
    one.size = sizeof one;
    for (std::size_t a = 0; a < 3; ++a) {
      one.reference_m[a] = kMetresPerMillimetre * pair.body_mm[a];
      one.measured_m[a] = kMetresPerMillimetre * pair.measured_mm[a];
    }
    out.push_back(one);
  }
  return out;
}

std::optional<double> numberAt(const Json &object, const char *key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

BodyMatch matchOf(const c3de_match_result &result, const Json &details) {
  constexpr double kMillimetres = 1.0 / kMetresPerMillimetre;
  BodyMatch out;
  out.hasConverged = (result.flags & C3DE_MATCH_CONVERGED) != 0;
  out.iterations = result.iterations;
  out.measuredFromBody = matrixOf(result.motion);
  out.before_mm = kMillimetres * result.before_m;
  out.rigid_mm = kMillimetres * result.rigid_m;
  out.after_mm = kMillimetres * result.after_m;
  out.usedPart = result.used_part;
  out.force_N = result.force_N;
  if ((result.flags & C3DE_MATCH_ERROR_KNOWN) != 0)
    out.error = {kMillimetres * result.error_m, kMillimetres * result.largest_error_m, result.unknown_part};
  for (const Json &point : details.value("points", Json::array())) {
    const auto distance_m = numberAt(point, "distance_m");
    out.distance_mm.push_back(distance_m ? std::optional(kMillimetres * *distance_m) : std::nullopt);
    out.weights.push_back(numberAt(point, "weight").value_or(0.0));
  }
  if (out.error)
    for (const Json &error_m : details.value("skin_error_m", Json::array()))
      out.skinErrors_mm.push_back(error_m.is_number() ? std::optional(kMillimetres * error_m.get<double>())
                                                      : std::nullopt);
  for (const Json &landmark : details.value("landmarks", Json::array()))
    out.landmarkErrors_mm.push_back(kMillimetres * numberAt(landmark, "error_m").value_or(0.0));
  return out;
}

Expected<c3de_handle> bodyNamed(c3de_object *simulator, const std::string &name) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  c3de_handle handle{};
  c3de_sim_body_info info{};
  info.size = sizeof info;
  for (std::uint64_t i = 0; (*table)->body_at(simulator, i, &handle) >= 0; ++i)
    if ((*table)->body_info(simulator, handle, &info) >= 0 && fromAbi(info.name) == name) return handle;
  return fail(ErrorCode::plugin, "the simulator has no body '" + name + "'");
}

}  // namespace

Expected<const c3de_matching_v0 *> matchingTable(c3de_object *simulator) {
  const auto found = queryObject(simulator, C3DE_IFACE_MATCHING_ID, 1);
  if (!found) return nullptr;
  const auto *table = static_cast<const c3de_matching_v0 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  return table;
}

Expected<BodyMatch> matchBody(c3de_object *simulator, const std::string &body,
                              const registration::MeasuredSurface &measured, const BodyMatchOptions &options,
                              const char *owner, const std::function<std::string()> &takeError,
                              const ProgressFn &progress) {
  const auto table = matchingTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (*table == nullptr) return fail(ErrorCode::plugin, "the simulator does not match bodies to measured points");
  const auto handle = bodyNamed(simulator, body);
  if (!handle) return tl::unexpected(handle.error());
  const std::vector<double> points = metres(measured.points_mm), normals = orientedNormals(measured);
  const std::vector<c3de_match_landmark> landmarks = landmarksOf(measured);
  c3de_match_request request{};
  request.size = sizeof request;
  request.body = *handle;
  request.points_m = points.data();
  request.normals = normals.empty() ? nullptr : normals.data();
  request.points_n = measured.points_mm.size();
  request.landmarks = landmarks.data();
  request.landmarks_n = landmarks.size();
  request.landmarks_stride = sizeof(c3de_match_landmark);
  request.flags = (options.isMotionKnown ? C3DE_MATCH_MOTION_KNOWN : 0u) |
                  (options.continuesLast ? C3DE_MATCH_CONTINUE : 0u) | (options.showsIterations ? C3DE_MATCH_SHOW : 0u);
  request.motion = motionOf(options.measuredFromBody);
  request.noise_m = kMetresPerMillimetre * options.noise_mm;
  request.support_Pa_m = kPascalsPerMetre * options.support_kPa_mm;
  c3de_match_result result{};
  result.size = sizeof result;
  PartProgress part(progress, "match", 0, 1);
  std::string text;
  const c3de_status code = part.call(owner, "a match", [&] {
    return (*table)->match(simulator, &request, part.abi(), &result, scene::sinkInto(text));
  });
  if (code < 0) {
    const std::string reason = takeError ? takeError() : std::string();
    if (code == C3DE_E_CANCELLED) return fail(ErrorCode::cancelled, "the match was cancelled");
    return fail(ErrorCode::plugin, reason.empty() ? "status " + std::to_string(code) : reason);
  }
  const Json details = Json::parse(text, nullptr, false);
  if (!details.is_object()) return fail(ErrorCode::plugin, "the details of the match are not a JSON object");
  BodyMatch out = matchOf(result, details);
  out.noise_mm = options.noise_mm;
  return out;
}

}  // namespace c3de::session
