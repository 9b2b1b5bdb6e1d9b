// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>

#include "simulator/world_simulator.h"

namespace pointbased {

/// What one simulator shows under its scene node: surfaces, interior points, obstacles, the world box with its floor,
/// the legend of its colours. Reads snapshots, which contain the view settings (view.…). Main thread. Created only if
/// the render and scene services are present.
class SimulatorView {
 public:
  SimulatorView(const Services &services, WorldSimulator &simulator, c3de_handle node);

  /// Displays the latest snapshot; does nothing if it is already shown.
  void update();
  /// The scene node of a body; nothing if it is not shown.
  [[nodiscard]] std::optional<c3de_handle> nodeOf(std::uint64_t body) const {
    const auto found = bodies_.find(body);
    return found == bodies_.end() ? std::nullopt : std::optional(found->second.node.handle());
  }

 private:
  struct BodyView {
    sdk::SceneNode node;
    sdk::Proxy surface, points;
    std::size_t pointCount = 0;
    PointsShown pointsShown = PointsShown::none;
    bool surfaceColoured = false, pointsColoured = false;
    const RestState *rest = nullptr;
    std::optional<std::uint64_t> changes, colours;  // of the displayed snapshot
  };
  struct ObstacleView {
    sdk::SceneNode node;
    sdk::Proxy mesh;
    Mat3 turned = Mat3::Identity();  // displayed rotation
    Vec3 moved = Vec3::Zero();       // m, of the corner of its box
  };
  [[nodiscard]] BodyView makeBody(const BodySnapshot &body) const;
  void updateBody(BodyView &view, const BodySnapshot &body, const ViewSettings &settings) const;
  void updatePoints(BodyView &view, const BodySnapshot &body, const ViewSettings &settings) const;
  void updateLegend(const Snapshot &snapshot);
  [[nodiscard]] ObstacleView makeObstacle(const ObstacleSnapshot &obstacle) const;
  void updateJaws(const Snapshot &snapshot);
  void updateBox(const WorldBox &box, const Vec3 &gravity);
  void drawFloor(const WorldBox &box, const Vec3 &gravity);

  const Services &services_;
  WorldSimulator &simulator_;
  c3de_handle node_;
  std::uint64_t shown_ = 0;
  std::map<std::uint64_t, BodyView> bodies_;
  std::map<std::uint64_t, ObstacleView> obstacles_;
  struct JawView {
    sdk::SceneNode node;
    std::array<sdk::Proxy, 2> discs;
    sdk::Proxy arms;
  };
  std::map<std::uint64_t, JawView> jaws_;  // of grasps
  sdk::SceneNode boxNode_;
  sdk::Proxy box_, floor_, floorGrid_, legend_;
  WorldBox shownBox_;
  Vec3 shownGravity_ = Vec3::Zero();
};

}  // namespace pointbased
