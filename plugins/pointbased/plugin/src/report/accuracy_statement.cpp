// SPDX-License-Identifier: Apache-2.0
#include "report/accuracy_statement.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "pointbased/error_estimate.h"
#include "report/advice.h"

namespace pointbased {
namespace {

constexpr double kNothingLeft = 0.98;  // volume fraction in singular regions above which the rest has no figure
constexpr double kMuchLeftOut = 0.5;   // volume fraction in singular regions above which the line states how little it
                                       // covers
constexpr double kMinInMillimetres = 1e-6;

std::string millimetres(double metres) { return twoDigits(1e3 * metres) + " mm"; }

std::string percent(double share) {
  return share > 0.0 && share < 1e-3 ? "less than 0.1 %" : twoDigits(100.0 * share) + " %";
}

std::string placeText(const Vec3 &at) {
  const auto axis = [](const char *name, double metres) {
    char text[40];
    // Adding 0 turns -0 into 0.
    std::snprintf(text, sizeof text, "%s %.0f", name, std::round(1e3 * metres) + 0.0);
    return std::string(text);
  };
  return axis("x", at[0]) + ", " + axis("y", at[1]) + ", " + axis("z", at[2]) + " mm";
}

std::string joined(const std::vector<std::string> &parts) {
  std::string text;
  for (const std::string &part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// The largest present displacement of a point of the skin, m, and the positions of all skin points.
struct SkinMotion {
  double largest = 0.0;
  std::vector<Vec3> reference, now;  // world, m
};

SkinMotion skinMotion(const Body &body) {
  const RestState &rest = body.rest();
  SkinMotion out;
  const std::span<const Vec3> u = body.state().displacements;
  if (rest.surfels.count() == 0) {
    for (std::size_t j = 0; j < u.size(); ++j) {
      out.reference.push_back(rest.origin + rest.positions[j]);
      out.now.push_back(out.reference.back() + u[j]);
    }
  } else {
    out.reference.resize(rest.surfels.count());
    out.now.resize(rest.surfels.count());
    for (std::size_t p = 0; p < out.reference.size(); ++p)
      out.reference[p] = rest.origin + rest.surfels.position(p, rest.positions);
    updateSurfels(rest.surfels, {}, rest.positions, u, out.now, {}, serialFor());
    for (Vec3 &x : out.now) x += rest.origin;
  }
  for (std::size_t p = 0; p < out.now.size(); ++p)
    out.largest = std::max(out.largest, (out.now[p] - out.reference[p]).norm());
  return out;
}

/// Present position of the skin point that is nearest to a position in the reference.
Vec3 nowAt(const SkinMotion &skin, const Vec3 &reference) {
  Vec3 out = reference;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < skin.reference.size(); ++p)
    if (const double squared = (skin.reference[p] - reference).squaredNorm(); squared < nearest) {
      nearest = squared;
      out = reference + (skin.now[p] - skin.reference[p]);
    }
  return out;
}

std::vector<std::string> touching(const Simulator &simulator, std::size_t id, const AccuracySources &sources) {
  std::vector<std::string> names;
  for (const ContactSummary &contact : simulator.diagnostics().contacts()) {
    if (contact.points == 0 || (contact.first != id && contact.second != id)) continue;
    const std::size_t other = contact.first == id ? contact.second : contact.first;
    names.push_back(other == id ? "itself" : other == kWorldBox ? "the walls" : "'" + sources.nameOfId(other) + "'");
  }
  return names;
}

void takeVerification(const Verification &verified, AccuracyStatement &out) {
  out.basis = AccuracyStatement::Basis::verified;
  out.largestDisplacement = verified.largestDisplacement;
  out.finer = static_cast<double>(verified.fineReferencePhyxels) /
              static_cast<double>(std::max<std::size_t>(1, verified.phyxels));
  if (!(verified.largestDisplacement > 0.0)) return;
  out.displacement = verified.error95;
  out.displacementAtMost = verified.errorMax;
  out.worst = verified.worst;
}

void estimateDisplacement(const Body &body, const AccuracySources &sources, const SkinMotion &skin,
                          bool isActedOnElsewhere, AccuracyStatement &out) {
  out.largestDisplacement = skin.largest;
  if (!sources.trials) {
    out.reason = "no trial solutions have been made yet";
    return;
  }
  if (!sources.trials->survey) {
    out.reason = sources.trials->failure;
    return;
  }
  const AccuracySurvey &survey = *sources.trials->survey;
  if (survey.supposed) {
    out.reason = "nothing holds it but contact, attachments or inertia, or nothing loads it";
    return;
  }
  out.basis = AccuracyStatement::Basis::estimated;
  const bool isMoved = skin.largest > kStrainFloor * survey.largest;
  if (!isMoved) out.largestDisplacement = survey.largest;
  out.displacement = predictError(survey, body.rest().spacing).likely * out.largestDisplacement;
  out.worst = nowAt(skin, survey.worst);
  out.reason = !isMoved             ? "expected at rest, nothing is displaced yet"
               : isActedOnElsewhere ? "at rest; excludes the effect of contact, attachments and grabs"
                                    : "at rest";
}

std::string displacementLine(const AccuracyStatement &of) {
  using enum AccuracyStatement::Basis;
  if (of.basis == none) return "Displacement: not estimated: " + of.reason + ". A verification measures it";
  const bool isVerified = of.basis == verified;
  const std::string how = isVerified ? "verified with " + twoDigits(of.finer) + " times the points"
                                     : "estimated by two coarser solutions, " + of.reason;
  if (!(of.displacement > 1e-3 * kMinInMillimetres)) return "Displacement: no error beyond rounding (" + how + ")";
  std::string text = "Displacement: ± " + millimetres(of.displacement) + " on 95 % of the skin (" + how + ")";
  if (of.worst)
    text += ", largest" +
            (of.displacementAtMost > 0.0 ? ", " + millimetres(of.displacementAtMost) + "," : std::string()) + " at " +
            placeText(*of.worst);
  return text;
}

std::string stressLine(const AccuracyStatement &of) {
  const std::string begin = "Stress and strain: ";
  if (!of.isStrained) return begin + "nothing is strained";
  if (of.leftOut > kNothingLeft)
    return begin + "no figure: at this spacing singular regions cover the whole body; use smaller cells";
  std::string text = begin + "± " + percent(of.stress) + " in the mean";
  if (!of.places.empty())
    text += of.leftOut > kMuchLeftOut
                ? " in the " + percent(1.0 - of.leftOut) + " of its volume outside singular regions"
                : " outside singular regions";
  if (!of.help.empty()) text += "; " + of.help;
  return text;
}

std::string placesLine(const AccuracyStatement &of) {
  if (of.places.empty()) return "Singular regions: none found";
  return "Singular regions: " + joined(of.places) + " (" + percent(of.leftOut) +
         " of the volume; excluded, because stress has no finite value there)";
}

}  // namespace

std::array<std::string, 3> AccuracyStatement::lines() const {
  return {displacementLine(*this), stressLine(*this), placesLine(*this)};
}

AccuracyStatement stateAccuracy(const Simulator &simulator, std::size_t id, const AccuracySources &sources,
                                ErrorScratch &scratch, const ParallelFor &parallelFor) {
  const Body &body = *simulator.body(id);
  AccuracyStatement out;
  out.whole = estimateError(body, nullptr, scratch, parallelFor).relative;
  std::vector<double> pressures;
  simulator.diagnostics().contactPressures(id, pressures);
  const SingularRegions places = findSingularRegions(body, pressures);
  out.stress = relativeErrorOutside(body, scratch, places);
  out.leftOut = places.volumePart;
  out.isStrained = out.whole > 0.0;
  for (const std::size_t f : places.fixes) {
    // A support without a name is identified by its number in the scene.
    const std::string name = f < sources.fixes.size() ? sources.fixes[f] : std::to_string(f);
    const bool isNumber = name.find_first_not_of("0123456789") == std::string::npos;
    out.places.push_back("edge of support " + (isNumber ? name : "'" + name + "'"));
  }
  const std::vector<std::string> touched = touching(simulator, id, sources);
  if (places.contact) {
    for (const std::string &name : touched) out.places.push_back("edge of contact with " + name);
    if (touched.empty()) out.places.emplace_back("edge of contact");
  }
  if (places.grabs) out.places.emplace_back("at a grab");
  out.help = errorAdvice(body, sources.area, out.stress);

  if (sources.verification && sources.verification->refused.empty()) {
    takeVerification(sources.verification->result, out);
    return out;
  }
  const std::vector<AttachmentSummary> attachments = simulator.world().attachments();
  const bool isAttached = std::any_of(attachments.begin(), attachments.end(),
                                      [&](const AttachmentSummary &a) { return a.first == id || a.second == id; });
  estimateDisplacement(body, sources, skinMotion(body), !touched.empty() || isAttached || places.grabs, out);
  return out;
}

}  // namespace pointbased
