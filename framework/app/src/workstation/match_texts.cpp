// SPDX-License-Identifier: Apache-2.0
#include "workstation/match_texts.h"

#include <fmt/format.h>

#include <cmath>

#include "c3de/core/path_text.h"
#include "c3de/geometry/rigid_fit.h"

namespace c3de::app {
namespace {

using Section = ui::MatchTexts::Section;

/// Without what only rounding has left.
double rounded(double value) {
  const double out = 1e-3 * std::round(1e3 * value);
  return out == 0.0 ? 0.0 : out;
}

std::string millimetres(double value) { return fmt::format("{:.3g} mm", rounded(value)); }

std::string poseText(const Mat4 &motion) {
  const geometry::RigidPose pose = geometry::poseOf(motion, {});
  return fmt::format("rotation ({:.4g}, {:.4g}, {:.4g})°, translation ({:.4g}, {:.4g}, {:.4g}) mm",
                     rounded(pose.rotation_deg[0]), rounded(pose.rotation_deg[1]), rounded(pose.rotation_deg[2]),
                     rounded(pose.translation_mm[0]), rounded(pose.translation_mm[1]), rounded(pose.translation_mm[2]));
}

const char *meaningOf(const RigidMatch &match) {
  using Verdict = registration::RegistrationVerdict;
  if (match.isGiven) return "The position was given";
  switch (match.rigid.verdict) {
    case Verdict::found: return "One motion fits, and the noise explains the residual";
    case Verdict::unexplained:
      return "One motion fits best, but the residual is larger than the noise explains. The body has changed its "
             "shape, or the points are of another body";
    case Verdict::ambiguous: return "Several motions fit equally well, or a part of the motion is not determined";
    case Verdict::refused: return "No motion is credible";
  }
  return "";
}

Section verdictSection(const MatchTargets &targets, const RigidMatch &match, std::optional<std::size_t> chosen) {
  const registration::RigidRegistration &rigid = match.rigid;
  Section out{"Result, not for clinical use", {}};
  out.rows.push_back({"Verdict", verdictOf(match)});
  out.rows.push_back({"Meaning", meaningOf(match)});
  if (chosen) out.rows.push_back({"Motion", fmt::format("candidate {}, chosen by you", *chosen + 1)});
  out.rows.push_back({"Measured", fmt::format("{} points from {}", match.points, pathText(targets.file.filename()))});
  out.rows.push_back({"Inliers", fmt::format("{:.0f} % within {:.3g} mm{}", 100.0 * rigid.after.inlierShare,
                                             rigid.after.limit_mm, match.isGiven ? "" : " after the motion")});
  if (match.isGiven) return out;
  out.rows.push_back({"Coverage", fmt::format("{:.0f} % of the surface", 100.0 * rigid.coverage)});
  out.rows.push_back(
      {"Error of motion", fmt::format("{:.2g} mm expected, without the change of shape", rigid.motionError_mm)});
  return out;
}

/// At rest, after the rigid motion, after the deformation.
Section errorSection(const RigidMatch &match, const ElasticMatch &elastic) {
  Section out{"Errors", {}};
  const auto add = [&](const char *of, const std::string &rest, const std::string &rigid, const std::string &deformed) {
    out.rows.push_back({std::string(of) + ", at rest", rest});
    if (!match.isGiven) out.rows.push_back({std::string(of) + ", rigid", rigid});
    if (!deformed.empty()) out.rows.push_back({std::string(of) + ", deformed", deformed});
  };
  add("Points", millimetres(match.rmsBefore_mm) + " rms", millimetres(match.rigid.after.rms_mm) + " rms",
      elastic.body ? millimetres(elastic.body->after_mm) + " rms" : std::string());
  if (match.before && match.after)
    add("Landmarks", errorText(*match.before), errorText(*match.after),
        elastic.after ? errorText(*elastic.after) : std::string());
  return out;
}

Section deformationSection(const ElasticMatch &elastic) {
  const BodyMatch &body = *elastic.body;
  Section out{"Deformation", {}};
  out.rows.push_back({"Iterations", fmt::format("{} in {:.3g} s{}", body.iterations, elastic.wall_s,
                                                body.hasConverged ? "" : ", not converged")});
  out.rows.push_back({"Points used", fmt::format("{:.0f} %", 100.0 * body.usedPart)});
  out.rows.push_back({"Forces", fmt::format("{:.3g} N, sum of magnitudes", body.force_N)});
  if (!body.error) {
    out.rows.push_back({"Expected error", "not known"});
    return out;
  }
  out.rows.push_back({"Expected error", fmt::format("{}{:.2g} mm rms, largest {:.2g}, without errors of the model",
                                                    body.error->isLowerBound() ? "at least " : "", body.error->rms_mm,
                                                    body.error->largest_mm)});
  out.rows.push_back(
      {"Unknown part", fmt::format("{:.0f} % of the body is hardly determined", 100.0 * body.error->unknownPart)});
  return out;
}

std::vector<ui::MatchTexts::Row> landmarkRows(const RigidMatch &match, const ElasticMatch &elastic) {
  std::vector<ui::MatchTexts::Row> rows;
  for (std::size_t i = 0; i < match.landmarks.size(); ++i) {
    const MatchedLandmark &one = match.landmarks[i];
    std::string text = fmt::format("{:.3g}", one.errorBefore_mm());
    if (!match.isGiven) text += fmt::format(" → {:.3g}", one.errorRigid_mm());
    if (i < elastic.landmarks_mm.size())
      text += fmt::format(" → {:.3g}", norm(elastic.landmarks_mm[i] - one.target_mm));
    rows.push_back({one.name, text + (one.isFitted ? " mm, fitted" : " mm")});
  }
  return rows;
}

}  // namespace

ui::MatchTexts textsOf(const MatchTargets &targets, const RigidMatch &match, const ElasticMatch &elastic,
                       std::optional<std::size_t> chosen) {
  ui::MatchTexts out;
  out.warnings = match.rigid.warnings;
  for (std::string &one : warningsOf(elastic)) out.warnings.push_back(std::move(one));
  for (const std::string &one : targets.notices) out.warnings.push_back(one);
  out.sections.push_back(verdictSection(targets, match, chosen));
  out.sections.push_back(errorSection(match, elastic));
  if (elastic.body) out.sections.push_back(deformationSection(elastic));
  if (!match.isGiven)
    out.sections.front().rows.push_back(
        {"Position", poseText(elastic.body ? elastic.body->measuredFromBody : match.rigid.measuredFromBody)});
  out.landmarks = landmarkRows(match, elastic);
  if (match.rigid.candidates.size() > 1)
    for (const registration::RegistrationCandidate &one : match.rigid.candidates)
      out.candidates.push_back(fmt::format("Candidate {}: {} rms, {}", out.candidates.size() + 1,
                                           millimetres(one.rms_mm), poseText(one.measuredFromBody)));
  out.shownCandidate = chosen.value_or(0);
  return out;
}

}  // namespace c3de::app
