// SPDX-License-Identifier: Apache-2.0
#include "bench/timing.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

namespace bench {
namespace {

constexpr int kTurns = 10;
constexpr std::size_t kMinRuns = 21;

// Runs without a sample until caches and clock rate have settled; a slow function runs only a few times.
void warmUp(double seconds, const std::function<void()> &f) {
  const double end_ms = wall_ms() + 0.1 * 1e3 * seconds;
  for (int i = 0; i < 10; ++i) {
    f();
    if (wall_ms() > end_ms) break;
  }
}

void sampleFor(double seconds, std::size_t least, std::vector<double> &samples, const std::function<void()> &f) {
  warmUp(seconds, f);
  const double end_ms = wall_ms() + 1e3 * seconds;
  const std::size_t enough = samples.size() + least;
  while (wall_ms() < end_ms || samples.size() < enough) {
    const double begin_ms = wall_ms();
    f();
    samples.push_back(wall_ms() - begin_ms);
  }
}

}  // namespace

Timing summaryOf(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto at = [&](std::size_t percent) {
    return samples[std::min(samples.size() - 1, samples.size() * percent / 100)];
  };
  return {at(50), at(1), at(95), at(99), samples.front(), samples.size()};
}

Timing measure(double seconds, const std::function<void()> &f) {
  std::vector<double> samples;
  sampleFor(seconds, kMinRuns, samples, f);
  return summaryOf(std::move(samples));
}

std::vector<Timing> measureInTurns(double seconds, const std::vector<std::function<void()>> &functions) {
  std::vector<std::vector<double>> samples(functions.size());
  for (int turn = 0; turn < kTurns; ++turn)
    for (std::size_t i = 0; i < functions.size(); ++i)
      sampleFor(seconds / kTurns, kMinRuns / kTurns + 1, samples[i], functions[i]);
  std::vector<Timing> out;
  for (std::vector<double> &s : samples) out.push_back(summaryOf(std::move(s)));
  return out;
}

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void keep(double value) {
  static std::atomic<double> kept{0.0};
  kept.store(value, std::memory_order_relaxed);
}

}  // namespace bench
