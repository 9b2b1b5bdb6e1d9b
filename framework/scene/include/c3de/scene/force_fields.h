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

class LentPoints;

/// Forces of plugins on the bodies of running simulations.
class ForceFields {
 public:
  ForceFields();
  ~ForceFields();

  struct Field {
    std::string name;
    std::string owner;  ///< the plugin's id
    Handle simulation;  ///< its node; null: all
    /// Below 0: not applied, and `takeError` says why.
    std::function<c3de_status(const c3de_force_call &)> apply;
    std::function<std::string()> takeError;
    bool isReported = false;  ///< that it writes to what is lent for reading
  };

  /// Any thread; null: not added, because this thread is applying a field.
  Handle add(Field field);
  enum class Removal { done, stale, fromApply };
  /// When this returns, the field is not being applied and will not be again. Any thread, but not while it applies one.
  /// @param owner  whose it has to be
  Removal remove(Handle field, const std::string &owner);
  void removeOwnedBy(const std::string &owner);

  /// Before a step, on its thread: lets every field of the simulation add its forces. The error names the first field
  /// that failed, which is removed; the step must not be made then.
  /// @param simulation  its node; null without a window
  [[nodiscard]] Expected<void> apply(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table);

 private:
  [[nodiscard]] Expected<void> applyTo(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table,
                                       c3de_handle body, double time_s);

  std::atomic<std::size_t> count_{0};  ///< so that a step without fields takes no lock
  std::mutex mutex_;                   ///< held while fields are applied
  std::atomic<std::thread::id> applying_{};
  std::map<std::uint64_t, Field> fields_;  ///< in the order they were added
  std::uint32_t next_ = 1;
  std::unique_ptr<LentPoints> lent_;
};

}  // namespace c3de::scene
