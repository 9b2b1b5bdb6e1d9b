// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "grab_patch.h"
#include "hand_tool.h"

namespace pointbased {

/// Press on the surface: the nearest surfel under the mouse is held, through the host's collision service; in a slice,
/// or on one that is seen in the 3D view: the material that is there, inside. Drag: a damped spring pulls its phyxels,
/// in a slice within its plane; release or Escape: let go. A marker shows where, an arrow the pull, a label the force.
/// While the simulation does not play the label says so, and what is held is pulled as soon as it does.
/// Where nothing can be held a label says why until the button is released.
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
    std::string what;                   ///< for people: the body, inside of it the tissue too
    std::optional<std::size_t> surfel;  ///< none: a point inside
    Vec3 point = Vec3::Zero();          ///< m, what is held, now
    Vec3 target = Vec3::Zero();         ///< m, where the hand is
    double force = 0.0;                 ///< N
    double mass = 0.0;                  ///< kg held
    std::string whyStill;               ///< HandTool::whyStill()
  };
  [[nodiscard]] const std::optional<Hold> &hold() const { return hold_; }
  /// Why the last press holds nothing; empty: it does, or met nothing in the 3D view.
  [[nodiscard]] const std::string &refusal() const { return refusal_; }

 private:
  bool press(const c3de_event &event);
  bool pressSurface(const Snapshot &snapshot, const PickRay &ray);
  void pressInside(const BodySnapshot *body, const Vec3 &place);
  [[nodiscard]] const BodySnapshot *bodyAt(const Snapshot &snapshot, const Vec3 &place) const;
  [[nodiscard]] PinchSettings ofTissue() const;
  void begin(const BodySnapshot &body, Grab grab, std::optional<std::size_t> surfel, const Vec3 &under);
  void refuse(const Vec3 &place, const std::string &why);
  void follow(const BodySnapshot &body);
  void drag(const c3de_event &event);
  void release();
  void showMarker(const BodySnapshot &body);
  void hideMarker();
  void leave() override { cancel(); }

  PinchSettings settings_;
  std::optional<Hold> hold_;
  Vec3 planePoint_ = Vec3::Zero();
  Vec3 grabOffset_ = Vec3::Zero();  // grabbed point minus the point under the mouse
  std::string refusal_;
  sdk::Proxy marker_, arrow_, label_;
};

}  // namespace pointbased
