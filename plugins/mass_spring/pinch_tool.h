// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/tool.hpp"
#include "simulator.h"

namespace mass_spring {

/// Press on a body and drag: a hand pulls the masses under the mouse; release or Escape lets go. Main thread.
class PinchTool : public sdk::Tool {
 public:
  explicit PinchTool(sdk::Host host) : scene_(host), collision_(host), render_(host), simulation_(host) {}
  /// Which simulator it works on; null: none. Lets go of the one before.
  void setSimulator(Simulator *simulator);
  bool onEvent(const c3de_event &event) override;
  void cancel() override { release(); }
  /// Arrow and label follow the latest snapshot. Once per frame.
  void update();

 private:
  struct Ray {
    Vec3 origin{}, direction{};  // in the node's frame, m
  };
  [[nodiscard]] std::optional<Ray> rayOf(const c3de_event &event) const;
  bool press(const c3de_event &event);
  void drag(const c3de_event &event);
  void release();
  void post(std::function<void(Simulator &)> command) const;

  sdk::Scene scene_;
  sdk::Collision collision_;
  sdk::Render render_;
  sdk::Simulation simulation_;
  sdk::Ref<Simulator> simulator_;
  std::optional<std::uint64_t> body_;  // that is held
  std::shared_ptr<c3de_handle> hold_;  // its hold, in the simulation's thread
  std::array<std::uint32_t, 3> under_{};
  Vec3 target_{}, viewDirection_{};
  sdk::Proxy line_, label_;
};

}  // namespace mass_spring
