// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "simulator/world_simulator.h"

namespace pointbased {

/// The undo steps of all tools, oldest first. Their states share one budget: while they need more, the oldest steps are
/// removed. Main thread.
class InteractionSteps;

/// Pulls, touches and moves as undo steps of the window: back to the state before the interaction, and forward again. A
/// restart of the simulation (a reset, another body) removes them. Main thread.
class InteractionHistory {
 public:
  /// @param steps  shared by all tools
  InteractionHistory(const Services &services, std::shared_ptr<InteractionSteps> steps)
      : services_(services), steps_(std::move(steps)) {}

  /// Called before the interaction begins.
  void begin(const sdk::Ref<WorldSimulator> &simulator);
  enum class Kind {
    simulation,  ///< no step if nothing has been simulated in between
    placement,   ///< for a placed object: a step in any case
  };
  /// Called when the interaction has ended.
  void end(const std::string &title, Kind kind = Kind::simulation);
  /// Removes the steps of a simulation that has been restarted. Called once per frame.
  void update();
  void clear();

 private:
  friend class InteractionSteps;
  class StoredCheckpoint;
  struct UndoState {
    sdk::Ref<WorldSimulator> simulator;
    std::shared_ptr<StoredCheckpoint> checkpoint;
    std::uint64_t historyEpoch = 0, steps = 0;
    std::size_t bytes = 0;  // of the stored state, approximately
    c3de_handle step{};
  };
  [[nodiscard]] sdk::Result<void> exchange(const UndoState &undo) const;
  [[nodiscard]] static bool isOutdated(const UndoState &undo);

  const Services &services_;
  std::optional<UndoState> pending_;
  std::shared_ptr<InteractionSteps> steps_;
};

class InteractionSteps {
 public:
  static constexpr std::size_t kBudget = std::size_t{256} << 20;  ///< bytes of the stored states

 private:
  friend class InteractionHistory;
  std::deque<InteractionHistory::UndoState> states_;
};

}  // namespace pointbased
