// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>

#include "pointbased/accuracy.h"
#include "pointbased/simulator.h"

namespace pointbased {

double measureFrame(const Body &body, const WorldSettings &world, std::span<const Obstacle> obstacles,
                    const ParallelFor &parallelFor) {
  constexpr double kLeast = 0.03;  // s of measuring
  constexpr std::size_t kFewest = 5;
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
  std::vector<double> frames;     // ms
  if (!alone.step()) return 0.0;  // it finds what the others keep
  const Clock::time_point begin = Clock::now();
  while (frames.size() < kFewest || seconds(begin) < kLeast) {
    const double time = alone.time();
    const Clock::time_point from = Clock::now();
    if (!alone.step()) break;
    const double stepped = seconds(from);
    const Clock::time_point drawn = Clock::now();
    alone.surfels(id, surfels, normals);
    if (const double simulated = alone.time() - time; simulated > 0.0)
      frames.push_back(1e3 * (stepped * kFrame / simulated + seconds(drawn)));
  }
  if (frames.empty()) return 0.0;
  const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2);
  std::nth_element(frames.begin(), middle, frames.end());
  return *middle;
}

}  // namespace pointbased
