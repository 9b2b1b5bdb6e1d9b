// SPDX-License-Identifier: Apache-2.0
#include "sensitivity/fit_statistics.h"

#include <cmath>

namespace pointbased::detail {

double studentLimit(std::size_t freedom) {
  constexpr double kPi = 3.14159265358979323846;
  constexpr int kIntervals = 400;  // of Simpson's rule
  constexpr double kHalf = 0.475;  // P(0 <= T <= t)
  const double n = static_cast<double>(freedom);
  const double scale = std::exp(std::lgamma(0.5 * (n + 1.0)) - std::lgamma(0.5 * n)) / std::sqrt(n * kPi);
  // With t = √n tan a the density becomes cos^(n-1) a, which is smooth on a finite interval.
  const auto density = [&](double a) { return scale * std::sqrt(n) * std::pow(std::cos(a), n - 1.0); };
  const auto probability = [&](double a) {
    double sum = density(0.0) + density(a);
    for (int i = 1; i < kIntervals; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(a * i / kIntervals);
    return sum * a / (3.0 * kIntervals);
  };
  double low = 0.0, high = 0.5 * kPi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (probability(middle) < kHalf ? low : high) = middle;
  }
  return std::sqrt(n) * std::tan(0.5 * (low + high));
}

double largestChiSquared(std::size_t freedom) {
  constexpr double kNormal = 3.0902;  // quantile 0.999
  const double n = static_cast<double>(freedom), spread = 2.0 / (9.0 * n);
  return n * std::pow(1.0 - spread + kNormal * std::sqrt(spread), 3.0);
}

bool areCorrelated(std::span<const double> residuals) {
  constexpr double kNormal = 3.0902;
  if (residuals.size() < kFewestForOrder) return false;
  const double n = static_cast<double>(residuals.size());
  double differences = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    squares += residuals[i] * residuals[i];
    if (i > 0) differences += (residuals[i] - residuals[i - 1]) * (residuals[i] - residuals[i - 1]);
  }
  if (!(squares > 0.0)) return false;
  return differences / squares < 2.0 - kNormal * std::sqrt(4.0 * (n - 2.0) / (n * n - 1.0));
}

}  // namespace pointbased::detail
