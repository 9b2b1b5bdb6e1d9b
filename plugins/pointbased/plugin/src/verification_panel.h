// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/sdk/panel.hpp"
#include "world_simulator.h"

namespace pointbased {

/// The part of the panel that verifies the paused state and shows the result as error bars. Main thread.
class VerificationPanel {
 public:
  explicit VerificationPanel(const Services &services) : services_(services) {}

  /// @param isMoving  the simulation plays: a verification would be of a state that is gone when it is told
  void draw(sdk::Ui &ui, WorldSimulator &simulator, const Snapshot *snapshot, bool isMoving);
  /// Begins a verification, beside the steps. Fails while one is under way.
  sdk::Result<void> begin(WorldSimulator &simulator);

 private:
  void finish(c3de_handle node, const sdk::Result<void> &result);

  const Services &services_;
  std::optional<c3de_handle> job_;
  std::string failure_;  // of the last one, for the panel
};

}  // namespace pointbased
