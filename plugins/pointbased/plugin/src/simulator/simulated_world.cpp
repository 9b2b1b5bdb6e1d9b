// SPDX-License-Identifier: Apache-2.0
#include "simulator/simulated_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/snapshot.h"

namespace pointbased {

void SimulatedWorld::reset() {
  simulator.reset();
  grasps.erase(kInteractiveGrasp);
  for (auto &[id, record] : grasps) {
    record.now.reset();
    record.isOver = false;
  }
  table.followInstruments(simulator);
  table.forgetInstruments();
}

std::uint64_t SimulatedWorld::takeIds(std::uint64_t count) { return std::exchange(nextId, nextId + count); }

void SimulatedWorld::recordGrab(std::uint64_t body, const Grab &grab) {
  constexpr std::size_t kMost = 8;
  BodyRecord *record = table.body(body);
  if (!record || grab.phyxels.empty()) return;
  const RestState &rest = simulator.body(body)->rest();
  SphereRegion place;
  for (std::size_t i = 0; i < grab.phyxels.size(); ++i)
    place.centre += grab.weights[i] * (rest.origin + rest.positions[grab.phyxels[i]]);
  for (const Index i : grab.phyxels)
    place.radius = std::max(place.radius, (rest.origin + rest.positions[i] - place.centre).norm());
  place.radius = std::max(place.radius, rest.spacing);
  std::vector<Load> &grabs = record->source.grabs;
  std::erase_if(grabs, [&](const Load &other) {
    return other.force.isZero(0.0) || signedDistance(other.region, place.centre) < 0.0;
  });
  if (grabs.size() >= kMost) grabs.erase(grabs.begin());
  grabs.push_back({place});
}

void SimulatedWorld::recordPull(std::uint64_t body, std::uint64_t hand) {
  const std::optional<GrabStatus> status = simulator.stepper().grabStatus(body, hand);
  BodyRecord *record = table.body(body);
  if (!record || record->source.grabs.empty() || !status) return;
  std::vector<Load> &grabs = record->source.grabs;
  const auto way = [&](const Load &load) { return std::abs(signedDistance(load.region, status->point)); };
  Vec3 &most = std::min_element(grabs.begin(), grabs.end(), [&](const Load &a, const Load &b) {
                 return way(a) < way(b);
               })->force;
  if (status->force.squaredNorm() > most.squaredNorm()) most = status->force;
}

}  // namespace pointbased
