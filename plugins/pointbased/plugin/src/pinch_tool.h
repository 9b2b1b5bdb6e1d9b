// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "grab_patch.h"
#include "hand_tool.h"

namespace pointbased {

/// Press on the surface: the nearest surfel under the mouse is held, through the host's collision service; drag: a
/// damped spring pulls its phyxels; release or Escape: let go. A marker shows where, an arrow the pull, a label the
/// force.
class PinchTool : public HandTool {
 public:
  explicit PinchTool(const Services &services);

  void setSettings(const PinchSettings &settings) { settings_ = settings; }

  bool onEvent(const c3de_event &event) override;
  void cancel() override;

  /// Marker and label follow the latest snapshot. Once per frame.
  void update();

  struct Hold {
    std::uint64_t body = 0;
    std::string bodyName;
    std::size_t surfel = 0;
    Vec3 surfelPosition = Vec3::Zero();  ///< m, now
    Vec3 target = Vec3::Zero();          ///< m, where the hand is
    double force = 0.0;                  ///< N
    double mass = 0.0;                   ///< kg held
  };
  [[nodiscard]] const std::optional<Hold> &hold() const { return hold_; }

 private:
  bool press(const c3de_event &event);
  void drag(const c3de_event &event);
  void release();
  void showMarker();
  void hideMarker();
  void leave() override { release(); }

  PinchSettings settings_;
  std::optional<Hold> hold_;
  Vec3 planePoint_ = Vec3::Zero();
  Vec3 grabOffset_ = Vec3::Zero();  // grabbed point minus the point under the mouse
  sdk::Proxy marker_, line_, label_;
};

}  // namespace pointbased
