// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation_directory.h"

#include <utility>

namespace c3de::scene {

void SimulationDirectory::add(Handle node, std::shared_ptr<Simulation> simulation) {
  const std::lock_guard lock(mutex_);
  byNode_[node.bits()] = std::move(simulation);
}

void SimulationDirectory::remove(Handle node) {
  // The last holder ends the simulation's thread, which may be waiting for this lock.
  std::shared_ptr<Simulation> gone;
  const std::lock_guard lock(mutex_);
  if (const auto found = byNode_.find(node.bits()); found != byNode_.end()) {
    gone = std::move(found->second);
    byNode_.erase(found);
  }
}

std::shared_ptr<Simulation> SimulationDirectory::find(Handle node) const {
  const std::lock_guard lock(mutex_);
  const auto found = byNode_.find(node.bits());
  return found != byNode_.end() ? found->second : nullptr;
}

}  // namespace c3de::scene
