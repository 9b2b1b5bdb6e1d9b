// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/first_frequency.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "c3de/core/text.h"

namespace c3de::study {
namespace {

/// Number of samples: few enough for direct summation of each spectral line.
constexpr std::size_t kSamples = 2048;
constexpr double kMinPeriods = 3.0, kPeakPart = 0.1;

/// Resamples at equal intervals. Each sample is the mean of the piecewise linear signal over its interval, so that
/// higher frequencies are damped rather than aliased.
std::vector<double> resampled(std::span<const double> time, std::span<const double> signal, std::size_t count) {
  std::vector<double> integral(time.size(), 0.0);
  for (std::size_t i = 1; i < time.size(); ++i)
    integral[i] = integral[i - 1] + 0.5 * (signal[i] + signal[i - 1]) * (time[i] - time[i - 1]);
  const double step = (time.back() - time.front()) / static_cast<double>(count);
  std::size_t at = 0;
  const auto integralAt = [&](double t) {
    while (at + 2 < time.size() && time[at + 1] < t) ++at;
    const double width = time[at + 1] - time[at], part = std::clamp((t - time[at]) / width, 0.0, 1.0);
    const double value = signal[at] + part * (signal[at + 1] - signal[at]);
    return integral[at] + 0.5 * (signal[at] + value) * part * width;
  };
  std::vector<double> out(count);
  double before = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double now = integralAt(time.front() + static_cast<double>(i + 1) * step);
    out[i] = (now - before) / step;
    before = now;
  }
  return out;
}

/// Subtracts the best-fitting straight line.
void detrend(std::vector<double> &signal) {
  const auto n = static_cast<double>(signal.size());
  double mean = 0.0, slope = 0.0, squares = 0.0;
  for (const double y : signal) mean += y / n;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double x = static_cast<double>(i) - 0.5 * (n - 1.0);
    slope += x * signal[i];
    squares += x * x;
  }
  slope /= squares;
  for (std::size_t i = 0; i < signal.size(); ++i)
    signal[i] -= mean + slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
}

/// Amplitude at a number of periods per signal length.
double amplitude(const std::vector<double> &windowed, double periods) {
  const std::complex<double> turn =
      std::polar(1.0, -2.0 * std::numbers::pi * periods / static_cast<double>(windowed.size()));
  std::complex<double> sum = 0.0, phase = 1.0;
  for (const double y : windowed) {
    sum += y * phase;
    phase *= turn;
  }
  return std::abs(sum);
}

}  // namespace

Expected<double> firstFrequency(std::span<const double> time_s, std::span<const double> signal) {
  const double duration = time_s.size() < 2 ? 0.0 : time_s.back() - time_s.front();
  if (time_s.size() < 16 || time_s.size() != signal.size() || !(duration > 0.0))
    return fail(ErrorCode::state,
                "the probe has " + std::to_string(time_s.size()) + " samples; at least 16 are needed");
  std::vector<double> windowed = resampled(time_s, signal, std::min(time_s.size(), kSamples));
  detrend(windowed);
  const auto n = static_cast<double>(windowed.size());
  for (std::size_t i = 0; i < windowed.size(); ++i)
    windowed[i] *= 1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / n);
  // Four lines per period of the whole signal: a peak of a Hann window is four periods wide.
  constexpr double kLine = 0.25;
  std::vector<double> lines;
  for (double periods = 0.0; periods <= 0.25 * n; periods += kLine) lines.push_back(amplitude(windowed, periods));
  const double highest = *std::max_element(lines.begin(), lines.end());
  double scale = 0.0;
  for (const double y : signal) scale = std::max(scale, std::abs(y - signal.front()));
  if (scale == 0.0 || !(highest > 1e-9 * scale * n)) return fail(ErrorCode::state, "the probe does not oscillate");
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    if (lines[i] < kPeakPart * highest || lines[i] < lines[i - 1] || lines[i] <= lines[i + 1]) continue;
    double low = (static_cast<double>(i) - 1.0) * kLine, high = (static_cast<double>(i) + 1.0) * kLine;
    for (int step = 0; step < 100; ++step) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      const bool rises = amplitude(windowed, a) < amplitude(windowed, b);
      (rises ? low : high) = rises ? a : b;
    }
    const double periods = 0.5 * (low + high);
    if (periods < kMinPeriods)
      return fail(ErrorCode::state, "the run has " + formatNumber(std::round(10.0 * periods) / 10.0) +
                                        " periods of the first frequency; at least 3 are needed, a longer 'until'");
    return periods / duration;
  }
  return fail(ErrorCode::state, "the probe does not oscillate");
}

}  // namespace c3de::study
