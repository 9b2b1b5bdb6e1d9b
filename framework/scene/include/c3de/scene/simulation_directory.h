// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "c3de/core/handle.h"
#include "c3de/scene/simulation.h"

namespace c3de::scene {

/// Which simulation stands behind a scene node; how plugins reach the one they were attached to. Any thread: whoever
/// has found a simulation keeps it alive while calling it.
class SimulationDirectory {
 public:
  void add(Handle node, std::shared_ptr<Simulation> simulation);
  void remove(Handle node);
  [[nodiscard]] std::shared_ptr<Simulation> find(Handle node) const;  ///< null: none

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Simulation>> byNode_;
};

}  // namespace c3de::scene
