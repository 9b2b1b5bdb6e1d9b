// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "simulator/world_simulator.h"

namespace pointbased {

/// Supports and loads that the user sets, changes and removes: each is a change of the simulation between two steps,
/// and a step of Undo. A change that the simulation refuses is reported, and its step of Undo is removed. Main thread.
class ConditionEdits {
 public:
  /// @param simulator  of the tool; it outlives this and may be null
  ConditionEdits(const Services &services, const sdk::Ref<WorldSimulator> &simulator)
      : services_(services), simulator_(simulator) {}
  ConditionEdits(const ConditionEdits &) = delete;
  ConditionEdits &operator=(const ConditionEdits &) = delete;

  /// Removes the undo steps, because the simulator changes or is removed.
  void clear();
  /// @param title          of the step of Undo
  /// @param before, after  nothing: it does not exist
  void change(const std::string &title, std::uint64_t number, std::optional<SurfaceCondition> before,
              std::optional<SurfaceCondition> after);
  void remove(const ConditionSnapshot &one);
  /// Number for a new condition: none had it before.
  [[nodiscard]] std::uint64_t nextNumber(const Snapshot &snapshot);
  /// Reports what the simulation has refused. Called once per frame.
  void update();
  /// Shows an error.
  void fail(const std::string &text) const;

 private:
  struct Refusals {
    std::mutex mutex;
    std::vector<std::pair<std::uint64_t, std::string>> all;  // attempt, reason
  };
  [[nodiscard]] sdk::Result<void> post(std::uint64_t attempt, std::uint64_t number,
                                       std::optional<SurfaceCondition> condition);

  const Services &services_;
  const sdk::Ref<WorldSimulator> &simulator_;
  std::map<std::uint64_t, c3de_handle> steps_;  // of Undo, by attempt
  std::uint64_t lastAttempt_ = 0, lastNumber_ = 0;
  std::shared_ptr<Refusals> refusals_ = std::make_shared<Refusals>();  // written by the thread of the simulation
};

}  // namespace pointbased
