// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include "c3de/collision/aabb_tree.h"
#include "c3de/core/text.h"
#include "c3de/geometry/winding_number.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/body_states.h"
#include "c3de/session/sample_points.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

using scene::kMillimetresPerMetre;
using TakeError = std::function<std::string()>;

constexpr std::size_t kListedLines = 20;

Expected<void> addLandmark(std::vector<Landmark> &all, Landmark one) {
  const auto same = std::find_if(all.begin(), all.end(), [&](const Landmark &other) { return other.name == one.name; });
  if (same != all.end())
    return fail(ErrorCode::input, one.where + ": a second landmark is named '" + displayText(one.name) +
                                      "', the first is in " + same->where + "; accepted: names that differ");
  all.push_back(std::move(one));
  return {};
}

Expected<void> addTarget(std::vector<Landmark> &all, const FileLandmark &target) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Landmark &one) { return one.name == target.name; });
  if (found != all.end()) {
    found->target_mm = target.lps_mm;
    return {};
  }
  std::vector<std::string> names;
  for (const Landmark &one : all) names.push_back(one.name);
  const std::string nearest = nearestName(target.name, names);
  return fail(ErrorCode::input, target.where + ": there is no landmark '" + displayText(target.name) + "'; " +
                                    (nearest.empty() ? "" : "did you mean '" + displayText(nearest) + "'? ") +
                                    "accepted: names of landmarks of the scene or of --landmarks");
}

/// The skin of a body at rest.
struct ReferenceSkin {
  std::string body;
  double spacing_mm = 0.0;
  geometry::WindingNumber winding;
  collision::AabbTree tree;

  /// 0 inside. mm
  [[nodiscard]] double distance(const Vec3 &at_mm) const {
    return winding.at(at_mm) > 0.5 ? 0.0 : std::abs(tree.closest(at_mm).distance);
  }
};

geometry::TriangleMesh referenceOf(const BodyState &body) {
  geometry::TriangleMesh mesh = body.skin;
  for (const geometry::PointArray &array : body.skinArrays)
    if (array.components == 3)
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        for (std::size_t a = 0; a < 3; ++a) mesh.vertices[v][a] -= array.values[3 * v + a];
  return mesh;
}

struct ReferenceBodies {
  std::vector<ReferenceSkin> skins;
  std::vector<std::string> skinless;  ///< bodies without a skin
};

Expected<ReferenceBodies> referenceBodies(c3de_object *simulator, const TakeError &takeError) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto states = readBodyStates(simulator, BodyParts::skin, takeError);
  if (!states) return tl::unexpected(states.error());
  ReferenceBodies out;
  for (std::size_t i = 0; i < states->size(); ++i) {
    const BodyState &body = (*states)[i];
    if (body.skin.triangles.empty()) {
      out.skinless.push_back(body.name);
      continue;
    }
    c3de_handle handle{};
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if ((*table)->body_at(simulator, i, &handle) < 0 || (*table)->body_info(simulator, handle, &info) < 0) continue;
    const geometry::TriangleMesh mesh = referenceOf(body);
    auto tree = collision::AabbTree::build(mesh.vertices, mesh.triangles);
    if (!tree) return fail(ErrorCode::plugin, "the skin of body '" + body.name + "': " + tree.error().message);
    out.skins.push_back(
        {body.name, info.spacing_m * kMillimetresPerMetre, geometry::WindingNumber(mesh), std::move(*tree)});
  }
  return out;
}

/// Whether `on` of a landmark means this body of the simulator: itself, or a piece of it.
bool isMeant(const scene::SceneFile &scene, const std::string &on, const std::string &body) {
  if (on == body) return true;
  for (const scene::SceneBody &whole : scene.bodies) {
    if (whole.volume.slides.empty()) continue;
    if (on == scene::nameOfRest(whole)) return body == whole.name;
    const auto pieces = scene::namesOfPieces(whole);
    if (on == whole.name) return std::find(pieces.begin(), pieces.end(), body) != pieces.end();
  }
  return false;
}

/// The nearest body that is meant; empty: none.
std::string nearestBody(const std::vector<ReferenceSkin> &skins, const scene::SceneFile &scene,
                        const Landmark &landmark) {
  std::string nearest;
  double least_mm = std::numeric_limits<double>::infinity();
  for (const ReferenceSkin &skin : skins) {
    if (!landmark.body.empty() && !isMeant(scene, landmark.body, skin.body)) continue;
    const double distance_mm = skin.distance(landmark.reference_mm);
    if (landmark.body.empty() && distance_mm > skin.spacing_mm) continue;
    if (distance_mm >= least_mm) continue;
    least_mm = distance_mm;
    nearest = skin.body;
  }
  return nearest;
}

/// Why a landmark cannot be followed in its body; nothing: it can.
std::optional<Error> whyNotFollowed(c3de_object *simulator, const Landmark &landmark, const TakeError &takeError) {
  const auto followed = positionsOf(simulator, {{landmark.body, landmark.at_m, 0}}, landmark.where, takeError);
  if (followed) return std::nullopt;
  Error error = followed.error();
  const std::string probe = "probe 'sample point 1'";  // what positionsOf() adds, which the user has not
  if (const auto at = error.message.find(probe); at != std::string::npos)
    error.message.replace(at, probe.size(), "landmark '" + displayText(landmark.name) + "'");
  return error;
}

/// Of bodies without a skin the first in which the simulator follows the landmark; empty: none.
std::string followingBody(c3de_object *simulator, const std::vector<std::string> &bodies, Landmark landmark,
                          const TakeError &takeError) {
  for (const std::string &body : bodies) {
    landmark.body = body;
    if (!whyNotFollowed(simulator, landmark, takeError)) return body;
  }
  return {};
}

/// A body as it is now.
struct PresentSkin {
  ReferenceSkin skin;
  std::vector<Vec3> vertices, shifts_mm;  ///< displacement of each vertex

  /// Of the nearest vertex.
  [[nodiscard]] Vec3 shiftAt(const Vec3 &at_mm) const {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (const double away = norm(vertices[v] - at_mm); away < least) least = away, nearest = v;
    return shifts_mm.empty() ? Vec3{} : shifts_mm[nearest];
  }
};

Vec3 solved(const std::array<Vec3, 3> &columns, const Vec3 &right) {
  const double det = dot(columns[0], cross(columns[1], columns[2]));
  if (std::abs(det) < 1e-6) return right;
  return {dot(right, cross(columns[1], columns[2])) / det, dot(columns[0], cross(right, columns[2])) / det,
          dot(columns[0], cross(columns[1], right)) / det};
}

/// Newton's method on the motion of the body, from a first guess; the guess where the simulator cannot follow it.
Vec3 referenceIn(c3de_object *simulator, const std::string &body, const Vec3 &now_m, const Vec3 &guess_m,
                 double spacing_m, const TakeError &takeError) {
  constexpr int kMostSteps = 20;
  constexpr double kClose_m = 1e-9;
  const double h = 0.02 * spacing_m;
  Vec3 at = guess_m, best = guess_m;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps && least > kClose_m; ++step) {
    const std::vector<SamplePoint> tried{
        {body, at, 0}, {body, at + Vec3{h, 0, 0}, 0}, {body, at + Vec3{0, h, 0}, 0}, {body, at + Vec3{0, 0, h}, 0}};
    const auto moved = positionsOf(simulator, tried, "point", takeError);
    if (!moved) break;
    const Vec3 residual = (*moved)[0] - now_m;
    if (norm(residual) >= least) break;
    least = norm(residual);
    best = at;
    std::array<Vec3, 3> columns;
    for (std::size_t a = 0; a < 3; ++a) columns[a] = (1.0 / h) * ((*moved)[a + 1] - (*moved)[0]);
    at = at - solved(columns, residual);
  }
  return best;
}

std::vector<SamplePoint> pointsOf(const std::vector<Landmark> &landmarks) {
  std::vector<SamplePoint> points;
  for (const Landmark &one : landmarks)
    if (!one.body.empty()) points.push_back({one.body, one.at_m, 0});
  return points;
}

std::optional<double> angleOf(const Vec3 &a, const Vec3 &vertex, const Vec3 &c) {
  const Vec3 u = a - vertex, v = c - vertex;
  if (norm(u) == 0.0 || norm(v) == 0.0) return std::nullopt;
  // Exact also near 0 and 180 degrees, where the arc cosine is not.
  return std::atan2(norm(cross(u, v)), dot(u, v)) * 180.0 / std::numbers::pi;
}

std::string textOf(const ErrorSummary &summary) {
  std::string text = fmt::format("mean {:.4g}", summary.mean_mm);
  if (summary.sd_mm) text += fmt::format(", sd {:.4g}", *summary.sd_mm);
  return text + fmt::format(", max {:.4g} mm", summary.max_mm);
}

std::string degrees(const std::optional<double> &angle_deg) {
  return angle_deg ? fmt::format("{:.4g} degrees", *angle_deg) : "undefined, because landmarks coincide";
}

}  // namespace

ErrorSummary summaryOf(const std::vector<double> &errors_mm) {
  ErrorSummary out;
  const auto n = static_cast<double>(errors_mm.size());
  for (const double error_mm : errors_mm) {
    out.mean_mm += error_mm / n;
    out.max_mm = std::max(out.max_mm, error_mm);
  }
  if (errors_mm.size() < 2) return out;
  double squares = 0.0;
  for (const double error_mm : errors_mm) squares += (error_mm - out.mean_mm) * (error_mm - out.mean_mm);
  out.sd_mm = std::sqrt(squares / (n - 1.0));
  return out;
}

Expected<std::vector<Landmark>> landmarksOf(const scene::SceneFile &scene,
                                            const std::vector<std::filesystem::path> &files,
                                            const std::vector<std::filesystem::path> &targets) {
  std::vector<Landmark> all;
  for (const scene::SceneLandmark &one : scene.landmarks) {
    Landmark landmark{one.name, one.body, one.at_m, kMillimetresPerMetre * one.at_m, {}, scene.where(one.line)};
    if (one.target_m) landmark.target_mm = kMillimetresPerMetre * *one.target_m;
    all.push_back(std::move(landmark));
  }
  for (const std::filesystem::path &file : files) {
    const auto read = readLandmarks(file);
    if (!read) return tl::unexpected(read.error());
    for (const FileLandmark &one : *read) {
      Vec3 at_m = one.lps_mm;
      for (double &x : at_m) x /= kMillimetresPerMetre;
      if (auto good = addLandmark(all, {one.name, {}, at_m, one.lps_mm, {}, one.where}); !good)
        return tl::unexpected(good.error());
    }
  }
  for (const std::filesystem::path &file : targets) {
    const auto read = readLandmarks(file);
    if (!read) return tl::unexpected(read.error());
    for (const FileLandmark &one : *read)
      if (auto good = addTarget(all, one); !good) return tl::unexpected(good.error());
  }
  return all;
}

Expected<void> setTargets(std::span<const FileLandmark> targets, std::vector<Landmark> &landmarks) {
  for (Landmark &one : landmarks) one.target_mm.reset();
  for (const FileLandmark &one : targets)
    if (auto good = addTarget(landmarks, one); !good) return good;
  return {};
}

Expected<void> findBodies(c3de_object *simulator, const scene::SceneFile &scene, std::vector<Landmark> &landmarks,
                          const std::function<std::string()> &takeError) {
  if (landmarks.empty()) return {};
  const auto bodies = referenceBodies(simulator, takeError);
  if (!bodies) return tl::unexpected(bodies.error());
  std::vector<bool> isNamed;
  for (Landmark &landmark : landmarks) {
    isNamed.push_back(!landmark.body.empty());
    const std::string nearest = nearestBody(bodies->skins, scene, landmark);
    if (!nearest.empty())
      landmark.body = nearest;
    else if (!isNamed.back())
      landmark.body = followingBody(simulator, bodies->skinless, landmark, takeError);
  }
  if (positionsOf(simulator, pointsOf(landmarks), "landmarks", takeError)) return {};
  // One of them cannot be followed: which?
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].body.empty()) continue;
    const auto error = whyNotFollowed(simulator, landmarks[i], takeError);
    if (!error) continue;
    if (isNamed[i] || error->code != ErrorCode::input) return tl::unexpected(*error);
    landmarks[i].body.clear();
  }
  return {};
}

Expected<std::vector<Vec3>> referencesOf(c3de_object *simulator, const std::vector<Vec3> &now_mm,
                                         const std::function<std::string()> &takeError) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto states = readBodyStates(simulator, BodyParts::skin, takeError);
  if (!states) return tl::unexpected(states.error());
  std::vector<PresentSkin> skins;
  for (std::size_t i = 0; i < states->size(); ++i) {
    const BodyState &body = (*states)[i];
    c3de_handle handle{};
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (body.skin.triangles.empty() || (*table)->body_at(simulator, i, &handle) < 0 ||
        (*table)->body_info(simulator, handle, &info) < 0)
      continue;
    auto tree = collision::AabbTree::build(body.skin.vertices, body.skin.triangles);
    if (!tree) return fail(ErrorCode::plugin, "the skin of body '" + body.name + "': " + tree.error().message);
    const geometry::TriangleMesh reference = referenceOf(body);
    std::vector<Vec3> shifts;
    for (std::size_t v = 0; v < reference.vertices.size(); ++v)
      shifts.push_back(body.skin.vertices[v] - reference.vertices[v]);
    skins.push_back(
        {{body.name, info.spacing_m * kMillimetresPerMetre, geometry::WindingNumber(body.skin), std::move(*tree)},
         body.skin.vertices,
         std::move(shifts)});
  }
  std::vector<Vec3> out;
  for (const Vec3 &now : now_mm) {
    const PresentSkin *nearest = nullptr;
    double least_mm = std::numeric_limits<double>::infinity();
    for (const PresentSkin &one : skins)
      if (const double away = one.skin.distance(now); away <= one.skin.spacing_mm && away < least_mm)
        least_mm = away, nearest = &one;
    if (!nearest) {
      out.push_back(now);
      continue;
    }
    constexpr double kMetres = 1.0 / kMillimetresPerMetre;
    const Vec3 guess_mm = now - nearest->shiftAt(now);
    // Exactly where it is, if the body has not moved there.
    if (norm(now - guess_mm) == 0.0) {
      const auto same = positionsOf(simulator, {{nearest->skin.body, kMetres * now, 0}}, "point", takeError);
      if (!same || norm(same->front() - kMetres * now) < 1e-12) {
        out.push_back(now);
        continue;
      }
    }
    out.push_back(kMillimetresPerMetre * referenceIn(simulator, nearest->skin.body, kMetres * now, kMetres * guess_mm,
                                                     kMetres * nearest->skin.spacing_mm, takeError));
  }
  return out;
}

Expected<Measurements> measure(c3de_object *simulator, const scene::SceneFile &scene,
                               const std::vector<Landmark> &landmarks, const std::function<std::string()> &takeError) {
  Measurements out;
  if (landmarks.empty()) return out;
  const auto positions_m = positionsOf(simulator, pointsOf(landmarks), "landmarks", takeError);
  if (!positions_m) return tl::unexpected(positions_m.error());
  std::map<std::string, std::size_t> byName;
  std::size_t next = 0;
  for (const Landmark &one : landmarks) {
    byName.emplace(one.name, out.landmarks.size());
    // The difference, so that a landmark that has not moved is exactly where it was.
    const Vec3 moved_m = one.body.empty() ? Vec3{} : (*positions_m)[next++] - one.at_m;
    out.landmarks.push_back({one, one.reference_mm + kMillimetresPerMetre * moved_m});
  }
  const auto at = [&](const std::string &name) -> const MeasuredLandmark & { return out.landmarks[byName.at(name)]; };
  for (const scene::SceneDistance &one : scene.distances) {
    const MeasuredLandmark &a = at(one.between[0]), &b = at(one.between[1]);
    out.distances.push_back({one.name, one.between, norm(a.landmark.reference_mm - b.landmark.reference_mm),
                             norm(a.position_mm - b.position_mm)});
  }
  for (const scene::SceneAngle &one : scene.angles) {
    const MeasuredLandmark &a = at(one.at[0]), &b = at(one.at[1]), &c = at(one.at[2]);
    out.angles.push_back({one.name, one.at,
                          angleOf(a.landmark.reference_mm, b.landmark.reference_mm, c.landmark.reference_mm),
                          angleOf(a.position_mm, b.position_mm, c.position_mm)});
  }
  return out;
}

std::optional<std::array<ErrorSummary, 2>> landmarkErrors(const Measurements &measurements) {
  std::vector<double> before_mm, after_mm;
  for (const MeasuredLandmark &one : measurements.landmarks) {
    if (!one.landmark.target_mm) continue;
    before_mm.push_back(one.errorBefore_mm());
    after_mm.push_back(one.errorAfter_mm());
  }
  if (before_mm.empty()) return std::nullopt;
  return std::array<ErrorSummary, 2>{summaryOf(before_mm), summaryOf(after_mm)};
}

std::vector<std::string> measurementLines(const Measurements &measurements) {
  std::vector<std::string> lines;
  for (const MeasuredLandmark &one : measurements.landmarks) {
    if (lines.size() == kListedLines) {
      lines.push_back(fmt::format("and {} more landmarks, which --report or --export-landmarks writes",
                                  measurements.landmarks.size() - kListedLines));
      break;
    }
    std::string text = "landmark '" + displayText(one.landmark.name) + "'";
    text += one.landmark.body.empty()
                ? std::string(": it lies in no body and does not move")
                : fmt::format(" of '{}': moved by {:.4g} mm", displayText(one.landmark.body), one.displacement_mm());
    if (one.landmark.target_mm)
      text += fmt::format("; {:.4g} mm from its target, {:.4g} mm at rest", one.errorAfter_mm(), one.errorBefore_mm());
    lines.push_back(std::move(text));
  }
  if (const auto errors = landmarkErrors(measurements))
    lines.push_back("landmark error: " + textOf((*errors)[1]) + "; at rest: " + textOf((*errors)[0]));
  for (const MeasuredDistance &one : measurements.distances)
    lines.push_back(fmt::format("distance '{}': {:.4g} mm, at rest {:.4g} mm ({:+.3g} mm)", displayText(one.name),
                                one.now_mm, one.reference_mm, one.now_mm - one.reference_mm));
  for (const MeasuredAngle &one : measurements.angles)
    lines.push_back(fmt::format("angle '{}': {}, at rest {}", displayText(one.name), degrees(one.now_deg),
                                degrees(one.reference_deg)));
  return lines;
}

}  // namespace c3de::session
