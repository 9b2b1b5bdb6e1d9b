// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "world_simulator.h"

namespace pointbased {

enum class SurfaceStyle : std::uint32_t { opaque, transparentWithPhyxels, phyxelsOnly };

/// What one simulator shows under its scene node: surfaces, phyxels, obstacles, the world box. Reads snapshots; main
/// thread. Present only when there is something to draw with.
class SimulatorView {
 public:
  SimulatorView(const Services &services, WorldSimulator &simulator, c3de_handle node);

  void setStyle(SurfaceStyle style);
  [[nodiscard]] SurfaceStyle style() const { return style_; }
  /// Takes the latest snapshot to the screen; does nothing when it is the one that is shown.
  void update();

 private:
  struct BodyView {
    sdk::SceneNode node;
    sdk::Proxy surface, phyxels;
    const RestState *rest = nullptr;
  };
  struct ObstacleView {
    sdk::SceneNode node;
    sdk::Proxy mesh;
  };
  [[nodiscard]] BodyView makeBody(const BodySnapshot &body) const;
  [[nodiscard]] ObstacleView makeObstacle(const ObstacleSnapshot &obstacle) const;
  void updateBox(const WorldBox &box);
  void applyStyle(const BodyView &view) const;

  const Services &services_;
  WorldSimulator &simulator_;
  c3de_handle node_;
  SurfaceStyle style_ = SurfaceStyle::opaque;
  std::uint64_t shown_ = 0;
  std::map<std::uint64_t, BodyView> bodies_;
  std::map<std::uint64_t, ObstacleView> obstacles_;
  sdk::SceneNode boxNode_;
  sdk::Proxy box_;
  WorldBox shownBox_;
};

}  // namespace pointbased
