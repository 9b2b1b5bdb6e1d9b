// SPDX-License-Identifier: Apache-2.0
#include "report/advice.h"

#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

// Bodies that pass through each other although their contact is on.
std::string describePassingBodies(const Simulator &simulator) {
  const std::vector<std::size_t> bodies = simulator.bodyIds();
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      const Body &first = *simulator.body(bodies[a]), &second = *simulator.body(bodies[b]);
      if ((first.isStatic() && second.isStatic()) || !simulator.world().contactPair(bodies[a], bodies[b]).enabled ||
          simulator.world().canTouch(bodies[a], bodies[b]))
        continue;
      return "bodies touch each other in explicit steps alone, and only where they have a skin: '" + first.name() +
             "' and '" + second.name() + "' pass through each other";
    }
  return {};
}

}  // namespace
namespace {

constexpr double kThinnest = 0.15;         // spacings, of the thickness: thinner bodies are refused
constexpr double kThinnestGood = 0.5;      // spacings, of the thickness: proposed instead
constexpr double kMaxPhyxels = 200'000.0;  // largest proposed count: more is too slow to wait for
// rms strain below which an error of the strain is meaningless
constexpr double kMinStrain = 1e-4;
constexpr double kReportedHeldShare = 0.25;                       // of the phyxels
constexpr double kErrorAimedAt = 0.95 * kReportedErrorThreshold;  // margin for the proposed sampling

std::string rounded(double count) {
  const double unit = std::pow(10.0, std::max(0.0, std::floor(std::log10(count)) - 1.0));
  return std::to_string(static_cast<std::uint64_t>(std::ceil(count / unit) * unit));
}

std::string millimetres(double metres) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g mm", 1e3 * metres);
  return text;
}

}  // namespace

double phyxelsAt(const RestState &rest, double area, double spacing) {
  const double d = rest.spacing, n = static_cast<double>(rest.phyxelCount());
  const double perArea = std::max(0.0, (n * d * d * d - rest.shapeVolume) / (area * d));
  return (rest.shapeVolume + perArea * area * spacing) / (spacing * spacing * spacing);
}

std::string describeCoarseness(const RestState &rest, double area) {
  if (rest.evaluation != Evaluation::stressPoints || !(area > 0.0)) return {};
  const double thickness = 2.0 * rest.shapeVolume / area;
  if (!(thickness < kThinnest * finestSpacing(rest.sampling, rest.spacing))) return {};
  const double good = thickness / kThinnestGood;
  char spacing[40];
  std::snprintf(spacing, sizeof spacing, "%.2g", good);
  return "the sampling is too coarse: a spacing of " + millimetres(rest.spacing) + " (" +
         std::to_string(rest.phyxelCount()) + " phyxels) for a body that is " + millimetres(thickness) +
         " thick in the mean (twice its volume over its area; of a tube the radius). Accepted: up to " +
         millimetres(thickness / kThinnest) + "; sampling.spacing = " + spacing +
         " or sampling.count = " + rounded(phyxelsAt(rest, area, good)) + " would do";
}

std::size_t heldPhyxels(const RestState &rest) {
  std::vector<std::uint8_t> held(rest.phyxelCount(), 0);
  for (const ConstrainedRegion &part : rest.conditions.held)
    for (const Index i : part.phyxels) held[i] = 1;
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), std::uint8_t{1}));
}

std::string errorAdvice(const Body &body, double area, double estimate) {
  const RestState &rest = body.rest();
  if (!(estimate > kReportedErrorThreshold) || !(area > 0.0)) return {};
  const ElasticEnergy energy = body.elasticEnergy(serialFor());
  const double scale = body.material().youngsModulus * rest.shapeVolume;
  if (!(energy.strain + energy.stabilisation > 0.5 * kMinStrain * kMinStrain * scale)) return {};
  const auto ratio = [](double e) { return std::sqrt(e * e / (1.0 - e * e)); };
  // Cells wider than the body's thickness do not resolve bending: the estimate begins to fall at a spacing equal to it.
  const double from = std::min(rest.spacing, 2.0 * rest.shapeVolume / area);
  const double spacing =
      from * std::pow(ratio(kErrorAimedAt) / ratio(std::min(estimate, 0.999)), 1.0 / kOrderOfEstimate);
  const double count = phyxelsAt(rest, area, spacing);
  if (!(count <= kMaxPhyxels))
    return "smaller cells where the error arises help (Refine here, sampling.adaptive = \"on\")";
  return "sampling.count = " + rounded(count) + " (spacing " + millimetres(spacing) + ") would bring it to 10 %";
}

std::vector<std::string> noticesOf(const Simulator &simulator, const std::vector<std::string> &errors) {
  std::vector<std::string> lines;
  const std::vector<std::size_t> bodies = simulator.bodyIds();
  for (const std::string &error : errors)
    if (!error.empty()) lines.push_back(error);
  for (const std::size_t id : bodies) {
    const Body &body = *simulator.body(id);
    const std::size_t held = heldPhyxels(body.rest()), all = body.rest().phyxelCount();
    if (!body.rigid() && static_cast<double>(held) > kReportedHeldShare * static_cast<double>(all))
      lines.push_back("body '" + body.name() + "': " + std::to_string(held) + " of its " + std::to_string(all) +
                      " phyxels are held, in rigid tissue or by supports; a requested count includes them");
    if (!body.rigid() && !body.rest().stencils.quadratic.points.empty() && body.constitution().hasHistory())
      lines.push_back("body '" + body.name() +
                      "': with flow or relaxation, quadratic cells slow each step by up to 20 times; "
                      "use sampling.order = \"linear\"");
  }
  constexpr std::size_t kMaxOfAKind = 3;
  for (const char *kind : {"warning", "stopped", "skin", "overlap", "step"}) {
    std::size_t count = 0;
    for (const SimulationEvent &event : simulator.diagnostics().events())
      if (event.kind == kind && ++count <= kMaxOfAKind) lines.push_back(event.text);
    if (count > kMaxOfAKind)
      lines.push_back("… and " + std::to_string(count - kMaxOfAKind) + " more events '" + kind + "'");
  }
  if (bodies.size() < 2) return lines;
  if (const std::string passing = describePassingBodies(simulator); !passing.empty()) lines.push_back(passing);
  std::string costs;
  for (const std::size_t id : bodies) {
    const double cost = simulator.diagnostics().costOf(id);
    if (!(cost > 0.0)) return lines;
    char text[160];
    const Body &body = *simulator.body(id);
    std::snprintf(text, sizeof text, "'%.60s' %.3g s (stable step %.3g s)", body.name().c_str(), cost,
                  body.stableStepAtRest());
    costs +=
        (costs.empty() ? "" : ", ") + (body.isFreeRigid() ? "'" + body.name() + "' " + shortNumber(cost) + " s" : text);
  }
  if (bodies.size() <= 8) lines.push_back("computing time per simulated second: " + costs);
  return lines;
}

}  // namespace pointbased
