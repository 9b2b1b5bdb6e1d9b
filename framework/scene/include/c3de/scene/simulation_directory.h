// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "c3de/core/handle.h"
#include "c3de/scene/simulation.h"

namespace c3de::scene {

/// Which simulation stands behind a scene node; how plugins reach the one they were attached to. Any thread.
class SimulationDirectory {
 public:
  void add(Handle node, Simulation *simulation);
  void remove(Handle node);
  [[nodiscard]] Simulation *find(Handle node) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Simulation *> byNode_;
};

}  // namespace c3de::scene
