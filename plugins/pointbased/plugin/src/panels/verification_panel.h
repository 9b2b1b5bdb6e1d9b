// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/sdk/panel.hpp"
#include "simulator/world_simulator.h"

namespace pointbased {

/// The part of the panel that verifies the paused state. Main thread.
class VerificationPanel {
 public:
  explicit VerificationPanel(const Services &services) : services_(services) {}

  /// The button, or the progress of the verification.
  /// @param isMoving  the simulation plays: the verified state would be outdated at the end
  void draw(sdk::Ui &ui, WorldSimulator &simulator, const Snapshot *snapshot, bool isMoving);
  /// What the latest result omits, and what was refused.
  void drawResult(sdk::Ui &ui, const Snapshot *snapshot);
  /// Starts a verification in parallel to the steps. Fails while one is running.
  sdk::Result<void> begin(WorldSimulator &simulator);

 private:
  void finish(c3de_handle node, const sdk::Result<void> &result);

  const Services &services_;
  std::optional<c3de_handle> job_;
  std::string failure_;  // of the last verification, for the panel
};

}  // namespace pointbased
