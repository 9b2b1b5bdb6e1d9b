// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/step_times.h"

#include <algorithm>
#include <cmath>

namespace c3de::session {
namespace {

constexpr std::size_t kMaxKept = std::size_t{1} << 20;

/// The smallest value that at least this fraction of the values does not exceed.
double quantile(std::vector<double> &values, double part) {
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void StepTimes::add(double step_ms) {
  max_ = std::max(max_, step_ms);
  if (count_++ % stride_ != 0) return;
  kept_.push_back(step_ms);
  if (kept_.size() < kMaxKept) return;
  for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize((kept_.size() + 1) / 2);
  stride_ *= 2;
}

StepTimes::Summary StepTimes::summary() const {
  if (kept_.empty()) return {};
  std::vector<double> values = kept_;
  return {quantile(values, 0.5), quantile(values, 0.99), max_};
}

}  // namespace c3de::session
