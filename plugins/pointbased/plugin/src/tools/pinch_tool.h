// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "instruments/grab_patch.h"
#include "tools/interactive_tool.h"

namespace pointbased {

/// Press on the surface: the nearest surfel under the mouse is grabbed, determined by the host's collision service.
/// Press in a slice, or on one visible in the 3D view: the material inside at that point is grabbed. Drag: a damped
/// spring pulls its phyxels; in a slice it pulls within the slice plane. Release or Escape: the grab is released. A
/// marker shows the position, an arrow the pull, a label the force. While the simulation does not play, the label
/// states this, and the pull acts as soon as it plays. Where nothing can be grabbed, a label states why until the
/// button is released. A grab of a state that was loaded is shown; Escape or the next press releases it.
class PinchTool : public InteractiveTool {
 public:
  PinchTool(const Services &services, std::shared_ptr<InteractionSteps> steps);

  void setSettings(const PinchSettings &settings) { settings_ = settings; }

  bool onEvent(const c3de_event &event) override;
  void cancel() override;

  /// Marker and label follow the latest snapshot. Called once per frame.
  void update();

  struct Hold {
    std::uint64_t body = 0;
    std::string what;                   ///< display text: the body, for an interior point also the tissue
    std::optional<std::size_t> surfel;  ///< none: an interior point
    Vec3 point = Vec3::Zero();          ///< m, present position of the held point
    Vec3 target = Vec3::Zero();         ///< m, target position
    double force = 0.0;                 ///< N
    double mass = 0.0;                  ///< kg, held mass
    std::string idleReason;             ///< InteractiveTool::idleReason()
    bool isRestored = false;            ///< of a state that was loaded: no button is pressed
  };
  [[nodiscard]] const std::optional<Hold> &hold() const { return hold_; }
  /// Why the last press grabbed nothing. Empty if it did, or if it hit nothing in the 3D view.
  [[nodiscard]] const std::string &refusal() const { return refusal_; }

 private:
  bool press(const c3de_event &event);
  bool pressSurface(const Snapshot &snapshot, const PickRay &ray);
  void pressInside(const BodySnapshot *body, const Vec3 &position);
  [[nodiscard]] const BodySnapshot *bodyAt(const Snapshot &snapshot, const Vec3 &position) const;
  [[nodiscard]] PinchSettings tissueSettings() const;
  void begin(const BodySnapshot &body, Grab grab, std::optional<std::size_t> surfel, const Vec3 &pressedPoint);
  void showRefusal(const Vec3 &position, const std::string &why);
  void updateHold(const BodySnapshot &body);
  /// Shows a grab that this tool has not begun.
  void showRestored(const Snapshot &snapshot);
  void drag(const c3de_event &event);
  void release();
  void showMarker(const BodySnapshot &body);
  void hideMarker();
  void detach() override { cancel(); }

  PinchSettings settings_;
  std::optional<Hold> hold_;
  Vec3 planePoint_ = Vec3::Zero();
  Vec3 grabOffset_ = Vec3::Zero();  // grabbed point minus the point under the mouse
  std::string refusal_;
  std::uint64_t releasing_ = 0;  // body whose grab the snapshot may still show; 0: none
  sdk::Proxy marker_, arrow_, label_;
};

}  // namespace pointbased
