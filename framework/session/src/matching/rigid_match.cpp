// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/rigid_match.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/imaging/surface.h"
#include "c3de/registration/surface_samples.h"
#include "c3de/session/measured_points.h"

namespace c3de::session {
namespace {

using MatchReport = nlohmann::ordered_json;
using registration::RegistrationVerdict;

constexpr const char *kNotClinical = "not for clinical use";

void addSamples(const geometry::TriangleMesh &mesh, bool isClosed, registration::MeasuredSurface &out) {
  registration::SurfaceSamples samples = registration::sampleSurface(mesh, kTargetSamples);
  out.points_mm = std::move(samples.points);
  out.normals = std::move(samples.normals);
  out.areNormalsOriented = isClosed;
}

Error ofFile(const Error &error, const std::filesystem::path &file) {
  const std::string name = pathText(file);
  const ErrorCode code = error.code == ErrorCode::usage ? ErrorCode::input : error.code;
  return {code,
          error.message.find(name) == std::string::npos ? displayMessage(name + ": " + error.message) : error.message};
}

void addLandmarks(const std::vector<Landmark> &landmarks, const scene::SceneMatch &match, RigidMatch &out) {
  std::vector<double> before, after;
  for (const Landmark &one : landmarks) {
    if (!one.target_mm) continue;
    out.landmarks.push_back({one.name, match.fitsLandmarks, one.reference_mm,
                             transformPoint(out.rigid.measuredFromBody, one.reference_mm), *one.target_mm});
    before.push_back(out.landmarks.back().errorBefore_mm());
    after.push_back(out.landmarks.back().errorRigid_mm());
  }
  if (before.empty()) return;
  out.before = summaryOf(before);
  out.after = summaryOf(after);
}

double rmsOfInliersBefore(const registration::RigidRegistration &rigid) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < rigid.after.distance_mm.size(); ++i)
    if (rigid.after.distance_mm[i] <= rigid.after.limit_mm)
      squares += rigid.before.distance_mm[i] * rigid.before.distance_mm[i], count += 1.0;
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

MatchReport rowsOf(const Mat4 &m) {
  MatchReport rows = MatchReport::array();
  for (std::size_t r = 0; r < 4; ++r) rows.push_back(MatchReport{m[r], m[4 + r], m[8 + r], m[12 + r]});
  return rows;
}

MatchReport jsonOfErrors(const ErrorSummary &of) {
  return MatchReport{
      {"mean", of.mean_mm}, {"sd", of.sd_mm ? MatchReport(*of.sd_mm) : MatchReport()}, {"max", of.max_mm}};
}

void addElastic(const RigidMatch &match, const ElasticMatch &elastic, MatchReport &json) {
  if (!elastic.body) return;
  const BodyMatch &body = *elastic.body;
  json["converged"] = match.isUsable() && body.hasConverged;
  json["iterations"] = body.iterations;
  json["surface_rms_mm"]["after"] = body.after_mm;
  json["forces"] = MatchReport::array({MatchReport{{"body", match.body}, {"sum_N", body.force_N}}});
  json["elastic"] = MatchReport{{"wall_s", elastic.wall_s},
                                {"used_part", body.usedPart},
                                {"expected_error_mm", nullptr},
                                {"largest_expected_error_mm", nullptr},
                                {"unknown_part", nullptr}};
  if (body.error) {
    json["elastic"]["expected_error_mm"] = body.error->rms_mm;
    json["elastic"]["largest_expected_error_mm"] = body.error->largest_mm;
    json["elastic"]["unknown_part"] = body.error->unknownPart;
  }
  if (!elastic.after) return;
  json["landmark_error_mm"]["after"] = jsonOfErrors(*elastic.after);
  for (std::size_t i = 0; i < elastic.landmarks_mm.size(); ++i) {
    MatchReport &one = json["landmarks"][i];
    one["after_mm"] = elastic.landmarks_mm[i];
    one["error_mm"]["after"] = norm(elastic.landmarks_mm[i] - match.landmarks[i].target_mm);
  }
}

void addRigidLines(const RigidMatch &match, std::vector<std::string> &lines) {
  const registration::RigidRegistration &rigid = match.rigid;
  lines.push_back(fmt::format(
      "surface: rms {:.3g} mm before, {:.3g} mm after the rigid motion; {:.0f} % of the points within {:.3g} mm",
      match.rmsBefore_mm, rigid.after.rms_mm, 100.0 * rigid.after.inlierShare, rigid.after.limit_mm));
  const geometry::RigidPose pose = geometry::poseOf(rigid.measuredFromBody, {});
  lines.push_back(
      fmt::format("motion: rotation ({:.4g}, {:.4g}, {:.4g}) degrees about x, y, z, then translation "
                  "({:.4g}, {:.4g}, {:.4g}) mm; expected error {:.2g} mm",
                  pose.rotation_deg[0], pose.rotation_deg[1], pose.rotation_deg[2], pose.translation_mm[0],
                  pose.translation_mm[1], pose.translation_mm[2], rigid.motionError_mm));
  lines.push_back(fmt::format("coverage: points were measured near {:.0f} % of the surface", 100.0 * rigid.coverage));
  if (match.before && match.after)
    lines.push_back(fmt::format("landmarks ({}, {}): {} before, {} after the rigid motion", match.landmarks.size(),
                                match.landmarks.front().isFitted ? "fitted" : "not fitted", errorText(*match.before),
                                errorText(*match.after)));
}

}  // namespace

std::string verdictOf(const RigidMatch &match) { return match.isGiven ? "given" : nameOf(match.rigid.verdict); }

std::vector<std::string> warningsOf(const ElasticMatch &elastic) {
  constexpr double kFewPoints =
      0.7;  // half of the points may be outliers; noise that was stated too small excludes as many
  std::vector<std::string> out;
  if (!elastic.failure.empty()) out.push_back("the body was not deformed: " + elastic.failure);
  if (!elastic.body) return out;
  if (!elastic.body->hasConverged) out.push_back("the deformation has not converged");
  constexpr double kUnexplained = 1.5;  // of the noise, as of the rigid search
  if (elastic.body->after_mm > kUnexplained * elastic.body->noise_mm)
    out.push_back(
        fmt::format("the deformation leaves distances of {:.3g} mm, which a noise of {:.3g} mm does not explain; the "
                    "points may be of "
                    "another body, or its position and supports may be others",
                    elastic.body->after_mm, elastic.body->noise_mm));
  if (elastic.body->usedPart < kFewPoints)
    out.push_back(
        fmt::format("the deformation uses {:.0f} % of the points: the others are farther away than the noise "
                    "explains; the noise may be larger, or they may be of another body",
                    100.0 * elastic.body->usedPart));
  if (const auto &error = elastic.body->error; error && error->isLowerBound())
    out.push_back(
        fmt::format("the points hardly determine {:.0f} % of the body, and its expected error is a lower bound; "
                    "measure more of its surface or landmarks near its supports, or give its position",
                    100.0 * error->unknownPart));
  if (!elastic.body->error) out.push_back("the error of the deformation is not known; do not trust it");
  return out;
}

std::string errorText(const ErrorSummary &errors) {
  return fmt::format("{:.3g}{} mm, at most {:.3g}", errors.mean_mm,
                     errors.sd_mm ? fmt::format(" ± {:.3g}", *errors.sd_mm) : "", errors.max_mm);
}

Expected<MatchTargets> readMatchTargets(const scene::SceneMatch &match, const geometry::MeshFormats &formats,
                                        BodySources &sources, const ProgressFn &progress) {
  MatchTargets out;
  if (!match.points.empty()) {
    out.file = match.points;
    auto read = readMeasuredPoints(match.points, match.unit);
    if (!read) return tl::unexpected(read.error());
    if (const auto good = checkNoLandmarks(*read); !good) return tl::unexpected(good.error());
    out.surface.points_mm = std::move(read->points_mm);
    out.surface.normals = std::move(read->normals);
    return out;
  }
  if (!match.surface.empty()) {
    out.file = match.surface;
    const auto loaded = formats.load(match.surface, match.unit, progress);
    if (!loaded) return tl::unexpected(ofFile(loaded.error(), out.file));
    out.notices = loaded->report.warnings;
    addSamples(loaded->mesh, loaded->report.closed, out.surface);
    return out;
  }
  out.file = match.labels.file;
  Preparation took;
  const auto picked = sources.pick(match.labels, progress, took);
  if (!picked) return tl::unexpected(ofFile(picked.error(), out.file));
  const auto surface = imaging::surfaceOf(picked->mask, {}, progress);
  if (!surface) return tl::unexpected(ofFile(surface.error(), out.file));
  addSamples(*surface, true, out.surface);
  return out;
}

Expected<RigidMatch> matchRigid(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                ThreadPool *pool, const ProgressFn &progress) {
  const auto begin = std::chrono::steady_clock::now();
  registration::MeasuredSurface measured = targets.surface;
  if (match.fitsLandmarks)
    for (const Landmark &one : landmarks)
      if (one.target_mm) measured.pairs.push_back({one.reference_mm, *one.target_mm});
  registration::RegistrationOptions options;
  options.noise_mm = match.noise_mm;
  options.pointsPerPair = match.landmarkWeight;
  auto rigid = registration::registerRigid(skin, measured, options, pool, progress);
  if (!rigid) return tl::unexpected(ofFile(rigid.error(), targets.file));
  RigidMatch out;
  out.body = match.body;
  out.file = targets.file;
  out.noise_mm = match.noise_mm;
  out.points = measured.points_mm.size();
  out.rigid = std::move(*rigid);
  out.rmsBefore_mm = rmsOfInliersBefore(out.rigid);
  addLandmarks(landmarks, match, out);
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

Expected<RigidMatch> matchInPlace(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                  const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                  ThreadPool *pool) {
  constexpr double kLimit = 3.0;  // standard deviations
  auto residuals =
      registration::residualsOf(skin, targets.surface.points_mm, kIdentity4, kLimit * match.noise_mm, pool);
  if (!residuals) return tl::unexpected(ofFile(residuals.error(), targets.file));
  RigidMatch out;
  out.body = match.body;
  out.file = targets.file;
  out.noise_mm = match.noise_mm;
  out.isGiven = true;
  out.points = targets.surface.points_mm.size();
  out.rigid.verdict = RegistrationVerdict::found;
  out.rigid.before = out.rigid.after = std::move(*residuals);
  out.rigid.candidates = {{kIdentity4, out.rigid.after.rms_mm, out.rigid.after.inlierShare}};
  out.rmsBefore_mm = out.rigid.after.rms_mm;
  addLandmarks(landmarks, match, out);
  return out;
}

Expected<RigidMatch> withCandidate(const RigidMatch &match, std::size_t candidate, const geometry::TriangleMesh &skin,
                                   const MatchTargets &targets, ThreadPool *pool) {
  if (candidate >= match.rigid.candidates.size())
    return fail(ErrorCode::usage, fmt::format("there is no candidate {}; accepted: 1 … {}", candidate + 1,
                                              match.rigid.candidates.size()));
  RigidMatch out = match;
  out.rigid.measuredFromBody = match.rigid.candidates[candidate].measuredFromBody;
  auto after = registration::residualsOf(skin, targets.surface.points_mm, out.rigid.measuredFromBody,
                                         match.rigid.after.limit_mm, pool);
  if (!after) return tl::unexpected(ofFile(after.error(), targets.file));
  out.rigid.after = std::move(*after);
  out.rmsBefore_mm = rmsOfInliersBefore(out.rigid);
  std::vector<double> errors_mm;
  for (MatchedLandmark &one : out.landmarks) {
    one.rigid_mm = transformPoint(out.rigid.measuredFromBody, one.reference_mm);
    errors_mm.push_back(one.errorRigid_mm());
  }
  if (!errors_mm.empty()) out.after = summaryOf(errors_mm);
  return out;
}

void addLandmarks(const RigidMatch &match, std::vector<Vec3> at_mm, ElasticMatch &out) {
  if (!out.body || at_mm.empty() || at_mm.size() != match.landmarks.size()) return;
  std::vector<double> errors_mm;
  for (std::size_t i = 0; i < at_mm.size(); ++i) {
    at_mm[i] = transformPoint(out.body->measuredFromBody, at_mm[i]);
    errors_mm.push_back(norm(at_mm[i] - match.landmarks[i].target_mm));
  }
  out.landmarks_mm = std::move(at_mm);
  out.after = summaryOf(errors_mm);
}

std::string matchJson(const RigidMatch &match, const ElasticMatch &elastic) {
  const registration::RigidRegistration &rigid = match.rigid;
  const Mat4 &motion = elastic.body ? elastic.body->measuredFromBody : rigid.measuredFromBody;
  const geometry::RigidPose pose = geometry::poseOf(motion, {});
  MatchReport json{
      {"stage", elastic.body ? "elastic" : "rigid"},
      {"notice", kNotClinical},
      {"body", match.body},
      {"measured", pathText(match.file)},
      {"points", match.points},
      {"noise_mm", match.noise_mm},
      {"wall_s", match.wall_s},
      {"verdict", verdictOf(match)},
      {"converged", match.isUsable() && elastic.failure.empty()},
      {"surface_rms_mm", {{"before", match.rmsBefore_mm}, {"rigid", rigid.after.rms_mm}}},
      {"surface_p95_mm", {{"before", rigid.before.p95_mm}, {"rigid", rigid.after.p95_mm}}},
      {"inlier_share", rigid.after.inlierShare},
      {"inlier_limit_mm", rigid.after.limit_mm},
      {"coverage", rigid.coverage},
      {"motion_error_mm", rigid.motionError_mm},
      {"motion",
       {{"matrix", rowsOf(motion)}, {"translation_mm", pose.translation_mm}, {"rotation_deg", pose.rotation_deg}}}};
  json["candidates"] = MatchReport::array();
  for (const registration::RegistrationCandidate &one : rigid.candidates)
    json["candidates"].push_back(MatchReport{
        {"matrix", rowsOf(one.measuredFromBody)}, {"surface_rms_mm", one.rms_mm}, {"inlier_share", one.inlierShare}});
  if (match.before && match.after)
    json["landmark_error_mm"] =
        MatchReport{{"before", jsonOfErrors(*match.before)}, {"rigid", jsonOfErrors(*match.after)}};
  json["landmarks"] = MatchReport::array();
  for (const MatchedLandmark &one : match.landmarks)
    json["landmarks"].push_back(
        MatchReport{{"name", one.name},
                    {"use", one.isFitted ? "fit" : "judge"},
                    {"reference_mm", one.reference_mm},
                    {"rigid_mm", one.rigid_mm},
                    {"target_mm", one.target_mm},
                    {"error_mm", {{"before", one.errorBefore_mm()}, {"rigid", one.errorRigid_mm()}}}});
  std::vector<std::string> warnings = rigid.warnings;
  addElastic(match, elastic, json);
  for (std::string &warning : warningsOf(elastic)) warnings.push_back(std::move(warning));
  json["warnings"] = warnings;
  return json.dump(-1, ' ', false, MatchReport::error_handler_t::replace);
}

std::vector<std::string> matchLines(const RigidMatch &match, const ElasticMatch &elastic) {
  const registration::RigidRegistration &rigid = match.rigid;
  std::vector<std::string> lines;
  lines.push_back(match.isGiven
                      ? fmt::format("{}: position given, {} points; {}", match.body, match.points, kNotClinical)
                      : fmt::format("{}: rigid motion {}, {} points in {:.3g} s; {}", match.body, nameOf(rigid.verdict),
                                    match.points, match.wall_s, kNotClinical));
  if (match.isGiven) {
    lines.push_back(fmt::format("surface: rms {:.3g} mm; {:.0f} % of the points within {:.3g} mm", match.rmsBefore_mm,
                                100.0 * rigid.after.inlierShare, rigid.after.limit_mm));
    if (match.before)
      lines.push_back(fmt::format("landmarks ({}, {}): {} at rest", match.landmarks.size(),
                                  match.landmarks.front().isFitted ? "fitted" : "not fitted",
                                  errorText(*match.before)));
  } else {
    addRigidLines(match, lines);
  }
  if (elastic.body) {
    const BodyMatch &body = *elastic.body;
    lines.push_back(
        fmt::format("deformed: rms {:.3g} mm after {} iterations in {:.3g} s{}; {:.0f} % of the points used; sum "
                    "of force magnitudes {:.3g} N",
                    body.after_mm, body.iterations, elastic.wall_s, body.hasConverged ? "" : ", not converged",
                    100.0 * body.usedPart, body.force_N));
    if (body.error)
      lines.push_back(
          fmt::format("expected error of the deformation: {}{:.2g} mm, largest {:.2g}; {:.0f} % of the body is "
                      "hardly determined",
                      body.error->isLowerBound() ? "at least " : "", body.error->rms_mm, body.error->largest_mm,
                      100.0 * body.error->unknownPart));
    if (elastic.after) lines.push_back("landmarks: " + errorText(*elastic.after) + " after the deformation");
  }
  for (const std::string &warning : warningsOf(elastic)) lines.push_back("  warning: " + warning);
  if (rigid.candidates.size() > 1)
    for (std::size_t i = 0; i < rigid.candidates.size(); ++i) {
      const geometry::RigidPose one = geometry::poseOf(rigid.candidates[i].measuredFromBody, {});
      lines.push_back(
          fmt::format("candidate {}: rms {:.3g} mm, rotation ({:.4g}, {:.4g}, {:.4g}) degrees, translation ({:.4g}, "
                      "{:.4g}, {:.4g}) "
                      "mm",
                      i + 1, rigid.candidates[i].rms_mm, one.rotation_deg[0], one.rotation_deg[1], one.rotation_deg[2],
                      one.translation_mm[0], one.translation_mm[1], one.translation_mm[2]));
    }
  return lines;
}

std::string residualTable(const MatchTargets &targets, const RigidMatch &match, const ElasticMatch &elastic) {
  std::string text = "x_mm,y_mm,z_mm,before_mm,rigid_mm,inlier,after_mm\n";
  const registration::RigidRegistration &rigid = match.rigid;
  for (std::size_t i = 0; i < targets.surface.points_mm.size(); ++i) {
    const Vec3 &p = targets.surface.points_mm[i];
    // Empty: there is no deformation, or no part of the surface faces the point.
    const auto after_mm =
        elastic.body && i < elastic.body->distance_mm.size() ? elastic.body->distance_mm[i] : std::nullopt;
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{}\n", p[0], p[1], p[2], rigid.before.distance_mm[i],
                        rigid.after.distance_mm[i], rigid.after.distance_mm[i] <= rigid.after.limit_mm ? 1 : 0,
                        after_mm ? fmt::format("{:.6g}", *after_mm) : std::string());
  }
  return text;
}

}  // namespace c3de::session
