// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "c3de/abi/forces.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/handle.h"

namespace c3de::scene {

class SharedPoints;

/// Plugin force fields that act on the bodies of running simulations.
class ForceFields {
 public:
  ForceFields();
  ~ForceFields();

  struct Field {
    std::string name;
    std::string owner;  ///< the plugin's id
    Handle simulation;  ///< its scene node; null: all simulations
    /// Below 0: not applied; `takeError` returns the reason.
    std::function<c3de_status(const c3de_force_call &)> apply;
    std::function<std::string()> takeError;
    bool isReported = false;  ///< writing to read-only arrays was reported
  };

  /// Any thread. Returns null if this thread is applying a field; the field is then not added.
  Handle add(Field field);
  enum class Removal { done, stale, fromApply };
  /// When this returns, the field is not being applied and will not be again. Any thread, but not while it applies a
  /// field.
  /// @param owner  the required owner
  Removal remove(Handle field, const std::string &owner);
  void removeOwnedBy(const std::string &owner);

  /// Call before a step, on its thread: lets every field of the simulation add its forces. The error names the first
  /// field that failed, which is removed; the step must then be skipped.
  /// @param simulation  its node; null without a window
  [[nodiscard]] Expected<void> apply(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table);

 private:
  [[nodiscard]] Expected<void> applyTo(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table,
                                       c3de_handle body, double time_s);

  std::atomic<std::size_t> count_{0};  ///< so that a step without fields needs no lock
  std::mutex mutex_;                   ///< held while fields are applied
  std::atomic<std::thread::id> applying_{};
  std::map<std::uint64_t, Field> fields_;  ///< in the order they were added
  std::uint32_t next_ = 1;
  std::unique_ptr<SharedPoints> lent_;
};

}  // namespace c3de::scene
