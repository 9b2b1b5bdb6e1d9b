// SPDX-License-Identifier: Apache-2.0
// Mass scaling.
#include <algorithm>
#include <cmath>

#include "forces/wave_stiffness.h"
#include "pointbased/body.h"

namespace pointbased {
namespace {

constexpr double kMaxAdded = 0.05;     // of the mass that can move: a usual bound where inertia matters
constexpr double kMinLonger = 1.5;     // of the step; otherwise no mass is added
constexpr double kCloseEnough = 0.99;  // of the requested step
constexpr int kRounds = 4;
constexpr int kHalvings = 50;

}  // namespace

std::pair<double, std::size_t> Body::addedMass() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < restMasses_.size(); ++i) {
    if (heldMask_[i] != 0 || !(masses_[i] > restMasses_[i])) continue;
    sum += masses_[i] - restMasses_[i];
    ++count;
  }
  return {sum, count};
}

void Body::scaleMasses(double step, const ParallelFor &parallelFor) {
  if (!restMasses_.empty()) masses_ = restMasses_;
  scaledStep_ = step;
  addMasses(parallelFor);
  updateMassDependents();
}

/// Starts from masses_ at rest; updates them, everything that depends on them, and the kernels.
void Body::addMasses(const ParallelFor &parallelFor) {
  restMasses_.clear();
  shareGravity();
  vectorise(parallelFor);
  restFrequency_ = frequencyAtRest(parallelFor);
  const double before = restFrequency_, wanted = scaledStep_ > 0.0 ? 2.0 / scaledStep_ : before;
  if (weights_.empty() || !(before > kMinLonger * wanted)) return;

  const std::vector<double> own = masses_;
  const std::vector<double> stiffness = detail::waveStiffnesses(constitution_, rest_->stencils, own.size(), parallelFor,
                                                                [](std::size_t) { return false; });
  const auto massAt = [&](std::size_t i, double bound) { return std::max(own[i], stiffness[i] / bound); };
  double movable = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) movable += heldMask_[i] != 0 ? 0.0 : own[i];
  const auto addedAt = [&](double bound) {
    double sum = 0.0;
    for (std::size_t i = 0; i < own.size(); ++i) sum += heldMask_[i] != 0 ? 0.0 : massAt(i, bound) - own[i];
    return sum;
  };
  for (int round = 0; round < kRounds && kCloseEnough * restFrequency_ > wanted; ++round) {
    double above = 0.0;
    for (std::size_t i = 0; i < own.size(); ++i) above = std::max(above, stiffness[i] / masses_[i]);
    double bound = above * (wanted / restFrequency_) * (wanted / restFrequency_);
    const bool isTooMuch = addedAt(bound) > kMaxAdded * movable;
    for (int k = 0; isTooMuch && k < kHalvings; ++k) {
      const double middle = 0.5 * (bound + above);
      (addedAt(middle) > kMaxAdded * movable ? bound : above) = middle;
    }
    if (isTooMuch) bound = above;
    for (std::size_t i = 0; i < own.size(); ++i) masses_[i] = massAt(i, bound);
    vectorise(parallelFor);
    restFrequency_ = frequencyAtRest(parallelFor);
    if (isTooMuch) break;
  }
  if (before >= kMinLonger * restFrequency_) {
    restMasses_ = own;
  } else {
    masses_ = own;
    vectorise(parallelFor);
    restFrequency_ = before;
  }
  shareGravity();
}

}  // namespace pointbased
