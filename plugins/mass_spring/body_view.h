// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator.h"

namespace mass_spring {

/// Shows the skins of a simulator under its node. Main thread.
class SimulatorView {
 public:
  SimulatorView(sdk::Host host, const Simulator &simulator, c3de_handle node)
      : scene_(host), render_(host), simulator_(simulator), node_(node) {}
  /// Follows the latest snapshot. Once per frame.
  void update();

 private:
  struct Shown {
    sdk::SceneNode node;
    sdk::Proxy skin;
  };
  sdk::Scene scene_;
  sdk::Render render_;
  const Simulator &simulator_;
  c3de_handle node_;
  std::shared_ptr<const Snapshot> shownSnapshot_;
  std::map<std::uint64_t, Shown> shown_;
};

}  // namespace mass_spring
