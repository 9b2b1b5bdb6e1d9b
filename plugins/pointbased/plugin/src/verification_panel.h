// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/sdk/panel.hpp"
#include "world_simulator.h"

namespace pointbased {

/// The part of the panel that verifies the paused state. Main thread.
class VerificationPanel {
 public:
  explicit VerificationPanel(const Services &services) : services_(services) {}

  /// The button, or how far the verification has come.
  /// @param isMoving  the simulation plays: a verification would be of an earlier state when it ends
  void draw(sdk::Ui &ui, WorldSimulator &simulator, const Snapshot *snapshot, bool isMoving);
  /// What the latest result leaves out, and what was refused.
  void drawResult(sdk::Ui &ui, const Snapshot *snapshot);
  /// Begins a verification, beside the steps. Fails while one is under way.
  sdk::Result<void> begin(WorldSimulator &simulator);

 private:
  void finish(c3de_handle node, const sdk::Result<void> &result);

  const Services &services_;
  std::optional<c3de_handle> job_;
  std::string failure_;  // of the last one, for the panel
};

}  // namespace pointbased
