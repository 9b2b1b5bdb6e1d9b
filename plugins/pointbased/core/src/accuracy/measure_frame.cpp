// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>

#include "pointbased/accuracy.h"
#include "pointbased/simulator.h"

namespace pointbased {

double measureFrame(const Body &body, const WorldSettings &world, std::span<const Obstacle> obstacles,
                    const ParallelFor &parallelFor, const StopRequest *stop) {
  constexpr double kSimulated = 0.5, kLongest = 0.5;  // s, simulated and of computing
  constexpr std::size_t kFewest = 5;                  // frames
  constexpr double kPart = 0.95;
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  Simulator alone(parallelFor);
  WorldSettings settings = world;
  settings.sleep = false;
  alone.setWorld(settings);
  if (alone.quasiStatic()) return 0.0;
  for (const Obstacle &obstacle : obstacles) alone.addObstacle(obstacle);
  auto copy = std::make_unique<Body>(body.name(), body.sharedRest(), body.constitution(), parallelFor);
  if (!copy->setFoundation(body.foundation().settings())) return 0.0;
  const std::size_t id = alone.addBody(std::move(copy));
  std::vector<Vec3f> surfels, normals;
  std::vector<double> frames;         // ms
  if (!alone.step(stop)) return 0.0;  // it finds what the others keep
  const Clock::time_point begin = Clock::now();
  while (frames.size() < kFewest || (alone.time() < kSimulated && seconds(begin) < kLongest)) {
    const double time = alone.time();
    const Clock::time_point from = Clock::now();
    while (alone.time() < time + kFrame)
      if (!alone.step(stop)) return 0.0;
    const double stepped = seconds(from) * kFrame / (alone.time() - time);
    const Clock::time_point drawn = Clock::now();
    alone.surfels(id, surfels, normals);
    frames.push_back(1e3 * (stepped + seconds(drawn)));
  }
  const auto at = frames.begin() + static_cast<std::ptrdiff_t>(kPart * static_cast<double>(frames.size() - 1));
  std::nth_element(frames.begin(), at, frames.end());
  return *at;
}

}  // namespace pointbased
