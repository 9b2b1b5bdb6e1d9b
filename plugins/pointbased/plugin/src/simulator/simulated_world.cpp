// SPDX-License-Identifier: Apache-2.0
#include "simulator/simulated_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/snapshot.h"

namespace pointbased {

void SimulatedWorld::reset() {
  ++resets;
  simulator.reset();
  grasps.erase(kInteractiveGrasp);
  for (auto &[id, record] : grasps) {
    record.now.reset();
    record.isReleased = false;
  }
  table.syncInstruments(simulator);
  table.clearInstrumentHistory();
}

std::uint64_t SimulatedWorld::allocateIds(std::uint64_t count) { return std::exchange(nextId, nextId + count); }

void SimulatedWorld::recordGrab(std::uint64_t body, const Grab &grab) {
  constexpr std::size_t kMost = 8;
  BodyRecord *record = table.body(body);
  if (!record || grab.phyxels.empty()) return;
  const RestState &rest = simulator.body(body)->rest();
  SphereRegion sphere;
  for (std::size_t i = 0; i < grab.phyxels.size(); ++i)
    sphere.centre += grab.weights[i] * (rest.origin + rest.positions[grab.phyxels[i]]);
  for (const Index i : grab.phyxels)
    sphere.radius = std::max(sphere.radius, (rest.origin + rest.positions[i] - sphere.centre).norm());
  sphere.radius = std::max(sphere.radius, rest.spacing);
  std::vector<Load> &grabs = record->source.grabs;
  std::erase_if(grabs, [&](const Load &other) {
    return other.force.isZero(0.0) || signedDistance(other.region, sphere.centre) < 0.0;
  });
  if (grabs.size() >= kMost) grabs.erase(grabs.begin());
  grabs.push_back({sphere});
}

void SimulatedWorld::recordPull(std::uint64_t body, std::uint64_t grabId) {
  const std::optional<GrabStatus> status = simulator.stepper().grabStatus(body, grabId);
  BodyRecord *record = table.body(body);
  if (!record || record->source.grabs.empty() || !status) return;
  std::vector<Load> &grabs = record->source.grabs;
  const auto distance = [&](const Load &load) { return std::abs(signedDistance(load.region, status->point)); };
  Vec3 &most = std::min_element(grabs.begin(), grabs.end(), [&](const Load &a, const Load &b) {
                 return distance(a) < distance(b);
               })->force;
  if (status->force.squaredNorm() > most.squaredNorm()) most = status->force;
}

void SimulatedWorld::show(std::uint64_t id, std::span<const Vec3> displacements) {
  if (saved_ && saved_.body != id) (void)restoreState();
  Body *body = simulator.body(id);
  if (!body || body->rest().phyxelCount() != displacements.size()) return;
  std::vector<Vec3> &now = body->state().displacements;
  if (!saved_) saved_ = {id, now};
  now.assign(displacements.begin(), displacements.end());
  body->invalidatePointValues();
  simulator.stepper().countChange(id);
}

SimulatedWorld::BodyShape SimulatedWorld::restoreState() {
  BodyShape shown = std::exchange(saved_, {});
  if (!shown) return shown;
  Body *body = simulator.body(shown.body);
  if (!body || body->rest().phyxelCount() != shown.displacements.size()) return {};
  body->state().displacements.swap(shown.displacements);
  body->invalidatePointValues();
  simulator.stepper().countChange(shown.body);
  return shown;
}

}  // namespace pointbased
