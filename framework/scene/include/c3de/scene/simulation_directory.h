// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/scene/simulation.h"

namespace c3de::scene {

/// Maps scene nodes to simulations; lets plugins access them and notifies plugins of their changes. Any thread, unless
/// stated otherwise: a caller of find() keeps the simulation alive while using it.
class SimulationDirectory {
 public:
  struct Entry {
    Handle node;
    std::string title;
    std::shared_ptr<Simulation> simulation;
  };
  struct Watch {
    std::string owner;                                                        ///< the plugin's id
    std::function<void(Handle node)> added, removed;                          ///< main thread
    std::function<void(Handle node, const c3de_sim_status &status)> stepped;  ///< on the simulation's thread
  };

  /// Notifies the watchers. Main thread.
  void add(Handle node, const std::string &title, std::shared_ptr<Simulation> simulation);
  void remove(Handle node);
  [[nodiscard]] std::shared_ptr<Simulation> find(Handle node) const;  ///< null: none
  [[nodiscard]] std::vector<Entry> all() const;                       ///< in the order they were added

  /// Calls added() for all existing simulations before it returns. Main thread.
  Handle watch(Watch watch);
  enum class Removal { done, stale, fromStepped };
  /// When this returns, none of its functions runs or will be called. Main thread.
  Removal unwatch(Handle watch, const std::string &owner);
  void unwatchOwnedBy(const std::string &owner);
  /// Notifies the watchers of a completed step. On the simulation's thread.
  void stepped(Handle node, const c3de_sim_status &status);

 private:
  void tell(Handle node, std::function<void(Handle)> Watch::*what);

  mutable std::mutex mutex_;
  std::vector<Entry> entries_;
  std::mutex watchMutex_;                 ///< held while watchers are notified of steps
  std::atomic<std::size_t> watchers_{0};  ///< so that a step without watchers needs no lock
  std::atomic<std::thread::id> telling_{};
  std::map<std::uint64_t, Watch> watches_;  ///< in the order they were added
  std::uint32_t next_ = 1;
};

}  // namespace c3de::scene
