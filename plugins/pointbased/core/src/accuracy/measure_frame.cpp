// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/work_timer.h"
#include "pointbased/accuracy.h"
#include "pointbased/simulator.h"

namespace pointbased {
namespace {

constexpr double kSimulated = 0.5, kLongest = 0.3;  // s, simulated time and computing time of one run
constexpr double kLongestOfAll = 2.0;               // s, computing time of all runs
constexpr std::size_t kFewest = 5;                  // frames; fewer once kLongestOfAll is reached
constexpr int kMaxRuns = 12;
constexpr double kConverged = 0.02;  // relative change of the result by a run
constexpr double kPart = 0.95;       // quantile of the frames

// Runs are repeated with identical results: for every step and every drawing the shortest time is used.
struct Timed {
  struct Step {
    double seconds = 0.0, simulated = 0.0;
    bool endsFrame = false;
    double drawn = 0.0;  // s
  };
  std::vector<Step> steps;

  [[nodiscard]] double frame() const {
    std::vector<double> frames;  // s
    double computed = 0.0, simulated = 0.0;
    for (const Step &step : steps) {
      computed += step.seconds;
      simulated += step.simulated;
      if (!step.endsFrame) continue;
      frames.push_back(computed * kFrame / simulated + step.drawn);
      computed = simulated = 0.0;
    }
    const auto at = frames.begin() + static_cast<std::ptrdiff_t>(kPart * static_cast<double>(frames.size() - 1));
    std::nth_element(frames.begin(), at, frames.end());
    return *at;
  }
};

}  // namespace

double measureFrame(const Body &body, const WorldSettings &world, std::span<const Obstacle> obstacles,
                    const ParallelFor &parallelFor, const StopRequest *stop) {
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
  if (!alone.step(stop)) return 0.0;  // caches that later steps reuse are filled here

  Timed timed;
  double computedOfAll = 0.0, frame = 0.0;
  int convergedRuns = 0;
  for (int run = 0; run < kMaxRuns; ++run) {
    alone.reset();
    double computed = 0.0, frameBegan = 0.0;
    std::size_t frames = 0;
    const auto hasNext = [&](std::size_t k) {
      if (run > 0) return k < timed.steps.size();
      return frames == 0 || (frames < kFewest && computed < kLongestOfAll) ||
             (alone.time() < kSimulated && computed < kLongest);
    };
    for (std::size_t k = 0; hasNext(k); ++k) {
      const double before = alone.time();
      const detail::WorkTimer stepped;
      if (!alone.step(stop)) return 0.0;
      const double seconds = stepped.seconds();
      computed += seconds;
      if (run == 0) timed.steps.push_back({seconds, alone.time() - before, false, 0.0});
      Timed::Step &step = timed.steps[k];
      step.seconds = std::min(step.seconds, seconds);
      if (run == 0) step.endsFrame = alone.time() >= frameBegan + kFrame;
      if (!step.endsFrame) continue;
      frameBegan = alone.time();
      ++frames;
      const detail::WorkTimer drawing;
      alone.world().surfels(id, surfels, normals);
      const double drawn = drawing.seconds();
      computed += drawn;
      step.drawn = run == 0 ? drawn : std::min(step.drawn, drawn);
    }
    computedOfAll += computed;
    const double now = timed.frame();
    convergedRuns = run > 0 && frame - now <= kConverged * now ? convergedRuns + 1 : 0;
    frame = now;
    if (computedOfAll > kLongestOfAll || convergedRuns >= 2) break;
  }
  return 1e3 * frame;
}

}  // namespace pointbased
