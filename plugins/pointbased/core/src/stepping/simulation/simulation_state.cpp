// SPDX-License-Identifier: Apache-2.0
#include "stepping/simulation/simulation_state.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/flush_denormals.h"

namespace pointbased::detail {
namespace {

constexpr double kStepWithoutBodies = 1.0 / 60.0;  // s
constexpr std::size_t kMaxEvents = 200;

// Same loop, with denormals flushed on every thread that runs a part of it.
ParallelFor flushing(ParallelFor parallelFor) {
  return [inner = std::move(parallelFor)](std::size_t n, std::size_t grain,
                                          const std::function<void(std::size_t, std::size_t)> &loop) {
    const auto part = [&loop](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      loop(begin, end);
    };
    inner(n, grain, std::cref(part));
  };
}

}  // namespace

SimulationState::SimulationState(ParallelFor loopsOfCaller)
    : plainLoops(flushing(std::move(loopsOfCaller))), loops(plainLoops), clock(stageNames()) {}

double SimulationState::stepSize() const {
  if (quasiStatic()) return 0.0;
  if (settings.dt > 0.0 && std::isfinite(settings.dt)) return settings.dt;
  // Step of the body with the longest one; the others divide it into substeps.
  double dt = 0.0;
  for (const auto &[id, stepper] : bodies) {
    if (stepper->body().isStatic()) continue;
    const double own = stepper->integratorIn(settings) == Integrator::explicitVerlet
                           ? kStepSafety * stepper->body().stableStepAtRest()
                           : kImplicitStep;
    if (std::isfinite(own)) dt = std::max(dt, own);
  }
  return dt > 0.0 ? dt : kStepWithoutBodies;
}

Body *SimulationState::body(std::size_t id) const {
  const auto found = bodies.find(id);
  return found == bodies.end() ? nullptr : &found->second->body();
}

const Obstacle *SimulationState::obstacle(std::size_t id) const {
  const auto found = std::find(obstacles.ids.begin(), obstacles.ids.end(), id);
  return found == obstacles.ids.end() ? nullptr
                                      : &obstacles.all[static_cast<std::size_t>(found - obstacles.ids.begin())];
}

void SimulationState::reportEvent(const std::string &kind, const std::string &text) {
  if (events.size() < kMaxEvents) events.push_back({time(), kind, text});
}

void SimulationState::addWarning(std::size_t id, const std::string &text) {
  warnings[id].push_back(text);
  reportEvent("warning", text);
}

void SimulationState::bindProbes(std::size_t id, std::span<const Vec3> shifts) {
  const Body &target = *body(id);
  for (std::size_t p = 0; p < probes.size(); ++p) {
    if (probes[p].body != id) continue;
    probes[p].referenceShift = shifts[p];
    const Vec3 local = probes[p].reference + shifts[p] - target.rest().origin;
    probes[p].binding = target.rest().bind(std::span<const Vec3>(&local, 1), {});
  }
}

bool SimulationState::removeObstacle(std::size_t id) {
  const auto found = std::find(obstacles.ids.begin(), obstacles.ids.end(), id);
  if (found == obstacles.ids.end()) return false;
  const auto number = found - obstacles.ids.begin();
  if (obstacles.instruments.erase(id) == 0) ++historyEpoch;
  obstacles.all.erase(obstacles.all.begin() + number);
  obstacles.ids.erase(found);
  obstacles.ownMotions.erase(id);
  obstacles.guidances.erase(id);
  placed.erase(id);
  warnings.erase(id);
  removeAttachmentsOf(id);
  std::erase_if(contact.pairs, [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  updateSurroundings();
  for (auto &[other, stepper] : bodies) {
    stepper->body().contact.removeObstacle(static_cast<Index>(ownObstacleCount(other) + number));
    stepper->wake();
  }
  return true;
}

void SimulationState::setMotion(std::size_t id, ObstacleMotion motion) {
  const auto found = std::find(obstacles.ids.begin(), obstacles.ids.end(), id);
  if (found == obstacles.ids.end()) return;
  obstacles.all[static_cast<std::size_t>(found - obstacles.ids.begin())].motion = motion;
  for (auto &[attachment, layer] : attachments)
    if (layer->settings().second == id) layer->setMotion(motion);
  updateSurroundings();
}

void SimulationState::guide(std::size_t id, const Guidance &guidance) {
  const Obstacle *found = obstacle(id);
  if (!found) return;
  obstacles.ownMotions.emplace(id, found->motion);
  obstacles.guidances.insert_or_assign(id, guidance);
  setMotion(id, guidance.motion());
}

void SimulationState::reset() {
  for (const std::size_t id : std::set<std::size_t>(obstacles.instruments)) removeObstacle(id);
  for (const auto &[id, motion] : std::map<std::size_t, ObstacleMotion>(obstacles.ownMotions)) setMotion(id, motion);
  obstacles.ownMotions.clear();
  obstacles.guidances.clear();
  for (auto &[id, stepper] : bodies) {
    const bool renewed = stepper->body().rereferenceCount() > 0;
    stepper->reset();
    if (renewed) bindProbes(id, std::vector<Vec3>(probes.size(), Vec3::Zero()));
  }
  skins.clear();
  for (const auto &island : islands.list) island->resetSolver();
  for (auto &[id, layer] : attachments) layer->resetTears();
  ++historyEpoch;
  progress = {};
  events.clear();
  for (const auto &[id, texts] : warnings)
    for (const std::string &warning : texts) reportEvent("warning", warning);
  reported = {};
  initialWarningsReported = false;
  computingTime = {};
}

}  // namespace pointbased::detail
