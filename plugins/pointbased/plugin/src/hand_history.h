// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>

#include "world_simulator.h"

namespace pointbased {

/// Pulls, touches and moves as steps of the window's Undo: back to the state before the hand was laid on, and on again.
/// What is simulated anew (a reset, another body) makes them go. Main thread.
class HandHistory {
 public:
  explicit HandHistory(const Services &services) : services_(services) {}

  /// Before the hand is laid on.
  void begin(const sdk::Ref<WorldSimulator> &simulator);
  enum class Of {
    time,   ///< no step where nothing has been simulated meanwhile
    place,  ///< where something was placed: a step also without
  };
  /// The hand has let go.
  void end(const std::string &title, Of of = Of::time);
  /// Forgets the steps of a simulation that has begun anew. Once per frame.
  void update();
  void forget();

 private:
  static constexpr std::size_t kMost = 20;  // each keeps a state of every body
  struct Kept {
    sdk::Ref<WorldSimulator> simulator;
    std::shared_ptr<HandState> state;  // of the simulation's thread
    std::uint64_t course = 0, steps = 0;
    c3de_handle step{};
  };
  [[nodiscard]] sdk::Result<void> exchange(const Kept &kept) const;
  [[nodiscard]] static bool isOld(const Kept &kept);

  const Services &services_;
  std::optional<Kept> present_;
  std::deque<Kept> done_;
};

}  // namespace pointbased
