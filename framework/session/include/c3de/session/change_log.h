// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "c3de/abi/iface/changes.h"
#include "c3de/core/expected.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// A change as its simulator reports it (iface/changes.h). Value type.
struct SimulationChange {
  std::string id, key, text;
  std::uint32_t flags = 0;  ///< C3DE_SIM_CHANGE_*
  std::uint64_t steps = 0;  ///< completed since the last reset when it was applied
  std::string bytes;

  friend bool operator==(const SimulationChange &, const SimulationChange &) = default;
};

/// Repeats a change. Errors (input) name the change and why the simulator refuses it. Call on the simulation's thread,
/// or before it runs.
/// @param takeError  returns the text of the last failed call
[[nodiscard]] Expected<void> applyChange(c3de_object *simulator, const SimulationChange &change,
                                         const std::function<std::string()> &takeError);

using SharedScene = std::shared_ptr<const scene::SceneFile>;
/// What a simulation was built from, in order: a scene, further scenes whose bodies were added, and persistent changes.
using SimulationSource = std::vector<std::variant<SharedScene, SimulationChange>>;

/// Records what a simulation is built from while it runs. Any thread.
class ChangeLog {
 public:
  /// Observes the simulator from now on, if it reports changes. Errors (plugin): its table is malformed.
  /// @param source  of the simulator so far
  [[nodiscard]] static Expected<std::unique_ptr<ChangeLog>> create(c3de_object *simulator, SimulationSource source);
  ChangeLog(const ChangeLog &) = delete;
  ChangeLog &operator=(const ChangeLog &) = delete;
  ~ChangeLog();

  /// False: the simulator does not report changes, and those of its panels and tools are not part of the source.
  [[nodiscard]] bool isComplete() const { return table_ != nullptr; }
  /// While bodies are being added by another thread, source and state do not belong together. Calls are nested.
  void beginAdding() { ++adding_; }
  void endAdding() { --adding_; }
  [[nodiscard]] bool isAdding() const { return adding_ > 0; }
  [[nodiscard]] bool isOf(const c3de_object *simulator) const { return simulator_ == simulator; }
  /// While it exists, changes that its thread makes are not recorded: those that leave the simulator as it was, such as
  /// probes that are added for reading only. One at a time; on the thread that steps the simulator, between two steps.
  class Unrecorded {
   public:
    explicit Unrecorded(ChangeLog &log) : log_(log) { log_.unrecorded_ = std::this_thread::get_id(); }
    ~Unrecorded() { log_.unrecorded_ = std::thread::id(); }
    Unrecorded(const Unrecorded &) = delete;
    Unrecorded &operator=(const Unrecorded &) = delete;

   private:
    ChangeLog &log_;
  };
  /// Bodies of a scene have been added.
  void addScene(SharedScene scene);
  [[nodiscard]] SimulationSource source() const;
  /// Persistent changes and scenes so far, superseded ones included.
  [[nodiscard]] std::uint64_t count() const;
  /// Called for every change, on the thread that makes it; must not call the simulator. Null: none. When this returns,
  /// the previous listener is not running.
  void setListener(std::function<void(const SimulationChange &)> listener);

 private:
  ChangeLog(c3de_object *simulator, SimulationSource source) : simulator_(simulator), source_(std::move(source)) {}
  void add(const c3de_sim_change &change);

  c3de_object *simulator_;
  const c3de_changes_v1 *table_ = nullptr;
  mutable std::mutex mutex_;
  SimulationSource source_;
  std::uint64_t count_ = 0;
  std::atomic<int> adding_{0};
  std::atomic<std::thread::id> unrecorded_{};
  std::mutex listenerMutex_;
  std::function<void(const SimulationChange &)> listener_;
};

/// Calls a function whose changes are not recorded (ChangeLog::Unrecorded).
/// @param log  null: none is kept
template <class Function>
auto unrecorded(const std::shared_ptr<ChangeLog> &log, const Function &function) {
  std::optional<ChangeLog::Unrecorded> pause;
  if (log) pause.emplace(*log);
  return function();
}

}  // namespace c3de::session
