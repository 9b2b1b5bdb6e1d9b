// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/richardson.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/core/assert.h"
#include "c3de/core/text.h"

namespace c3de::study {
namespace {

constexpr double kMinOrder = 0.1, kMaxOrder = 4.0, kSafety = 1.25;

double normOf(const std::vector<double> &f, const std::vector<double> &weights) {
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (!std::isfinite(f[i])) return std::numeric_limits<double>::quiet_NaN();  // std::max() would skip it
    largest = std::max(largest, std::abs(f[i]));
    if (!weights.empty()) sum += weights[i] * f[i] * f[i];
  }
  return weights.empty() ? largest : std::sqrt(sum);
}

std::vector<double> difference(const std::vector<double> &a, const std::vector<double> &b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

/// (h1^p - h2^p) / (h2^p - h3^p), which increases with p.
double ratioAt(const std::array<double, 3> &h, double p) {
  const double a = std::pow(h[0] / h[1], p), c = std::pow(h[2] / h[1], p);
  return (a - 1.0) / (1.0 - c);
}

}  // namespace

Expected<Extrapolation> extrapolate(const std::array<double, 3> &h, const std::array<std::vector<double>, 3> &f,
                                    const std::vector<double> &weights) {
  C3DE_ASSERT(h[0] > h[1] && h[1] > h[2] && h[2] > 0.0, "steps fall");
  C3DE_ASSERT(f[0].size() == f[1].size() && f[1].size() == f[2].size(), "runs of the same quantities");
  const std::vector<double> coarse = difference(f[0], f[1]), fine = difference(f[1], f[2]);
  const double coarseSize = normOf(coarse, weights), fineSize = normOf(fine, weights);
  if (!std::isfinite(coarseSize) || !std::isfinite(fineSize)) return fail(ErrorCode::state, "a run is not finite");
  Extrapolation out;
  if (fineSize == 0.0 && coarseSize == 0.0) {
    out.value = f[2];
    out.order = std::numeric_limits<double>::infinity();
    return out;
  }
  const std::string differences =
      "; the first two runs differ by " + formatNumber(coarseSize) + ", the last two by " + formatNumber(fineSize);
  if (f[0].size() == 1 && coarse[0] * fine[0] < 0.0)
    return fail(ErrorCode::state, "the value oscillates from run to run" + differences);
  const double ratio = fineSize > 0.0 ? coarseSize / fineSize : std::numeric_limits<double>::infinity();
  if (!(ratio > ratioAt(h, kMinOrder)))
    return fail(ErrorCode::state, "the observed order is not positive" + differences);
  double low = kMinOrder, high = 50.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (ratioAt(h, middle) < ratio ? low : high) = middle;
  }
  out.order = fineSize > 0.0 ? low : std::numeric_limits<double>::infinity();
  const double used = std::min(out.order, kMaxOrder);
  const double factor = 1.0 / (std::pow(h[1] / h[2], used) - 1.0);
  std::vector<double> correction = fine;
  for (double &value : correction) value *= -factor;
  out.value = f[2];
  for (std::size_t i = 0; i < out.value.size(); ++i) out.value[i] += correction[i];
  out.uncertainty = kSafety * normOf(correction, weights);
  return out;
}

}  // namespace c3de::study
