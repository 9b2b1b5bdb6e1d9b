// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation_directory.h"

namespace c3de::scene {

void SimulationDirectory::add(Handle node, Simulation *simulation) {
  const std::lock_guard lock(mutex_);
  byNode_[node.bits()] = simulation;
}

void SimulationDirectory::remove(Handle node) {
  const std::lock_guard lock(mutex_);
  byNode_.erase(node.bits());
}

Simulation *SimulationDirectory::find(Handle node) const {
  const std::lock_guard lock(mutex_);
  const auto found = byNode_.find(node.bits());
  return found != byNode_.end() ? found->second : nullptr;
}

}  // namespace c3de::scene
