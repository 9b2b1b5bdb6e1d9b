// SPDX-License-Identifier: Apache-2.0
#include "grab_patch.h"

#include <algorithm>

#include "pointbased/types.h"

namespace pointbased {
namespace {

constexpr double kLeastRadius = 2.0;  // spacings: a patch of a few phyxels at any sampling
// The pull is limited to this many times E r²: it strains the held patch by several hundred per cent, and no more
// however far the hand is torn away.
constexpr double kStrongestPull = 4.0;

Vec3 positionOf(const Body &body, Index i) {
  return body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
}

}  // namespace

Grab patchAround(const RestState &rest, const Vec3 &at, double radius, std::size_t surfel) {
  Grab grab;
  double sum = 0.0;
  std::vector<std::uint8_t> held(rest.phyxelCount(), 0);
  for (const ConstrainedRegion &part : rest.conditions.held)
    for (const Index i : part.phyxels) held[i] = 1;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    if (held[i]) continue;
    const double weight = rest.volumes[i] * kernelWeight((rest.positions[i] - at).norm(), radius);
    if (weight <= 0.0) continue;
    grab.phyxels.push_back(static_cast<Index>(i));
    grab.weights.push_back(weight);
    sum += weight;
  }
  for (double &w : grab.weights) w /= sum;
  if (!grab.phyxels.empty()) return grab;
  const Interpolation binding = rest.surfels.expanded(surfel, rest.positions);
  grab.phyxels = binding.phyxels.indices;
  grab.weights = binding.weights;
  return grab;
}

Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings, double youngsModulus) {
  const double radius = std::max(1e-3 * settings.radius_mm, kLeastRadius * rest.spacing);
  Grab grab = patchAround(rest, rest.surfels.position(surfel, rest.positions), radius, surfel);
  grab.frequency = 2.0 * EIGEN_PI * settings.frequency_hz;
  grab.dampingRatio = settings.dampingRatio;
  grab.maxForce = kStrongestPull * youngsModulus * radius * radius;
  if (settings.largestForce > 0.0) grab.maxForce = std::min(grab.maxForce, settings.largestForce);
  return grab;
}

Vec3 middleOf(const Grab &grab, const Body &body) {
  Vec3 middle = Vec3::Zero();
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) middle += grab.weights[k] * positionOf(body, grab.phyxels[k]);
  return middle;
}

Vec3 keepShape(Grab &grab, const Body &body) {
  grab.target = middleOf(grab, body);
  grab.arms.clear();
  for (const Index i : grab.phyxels) grab.arms.push_back(positionOf(body, i) - grab.target);
  return grab.target;
}

}  // namespace pointbased
