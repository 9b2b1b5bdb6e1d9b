// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tools/force_curve.h"
#include "tools/interactive_tool.h"

namespace pointbased {

/// Two jaws that grasp a fold of tissue. Press on an organ: the jaws grasp it on either side and close. Drag: they
/// move parallel to the screen. Wheel: they rotate about the view's axis. Release: they stay, and a press on one of
/// them resumes. An arrow shows the pull, a label its magnitude and the squeeze.
class GraspTool : public InteractiveTool {
 public:
  GraspTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
      : InteractiveTool(services, std::move(steps)) {}

  [[nodiscard]] const GraspSettings &settings() const { return settings_; }
  /// Settings chosen by the user, for the next grasp. Until set, the jaws are at least two spacings of the first
  /// grasped body.
  void setSettings(const GraspSettings &settings);

  bool onEvent(const c3de_event &event) override;
  /// Ends a drag; the jaws stay at their position.
  void cancel() override;
  void releaseGrasp();
  /// Markers follow the latest snapshot. Called once per frame.
  void update();

  /// Of both jaws together, on the tissue.
  [[nodiscard]] const ForceCurve &forces() const { return forces_; }

 private:
  struct Pose {
    Vec3 middle = Vec3::Zero();
    Mat3 rotation = Mat3::Identity();
  };
  struct Drag {
    Vec3 point = Vec3::Zero();   // m, where the button was pressed: the drag moves in the plane through it
    Vec3 offset = Vec3::Zero();  // m, from the point under the mouse to the middle
  };
  struct MouseSample {
    c3de_event event{};
    PickRay ray;
  };
  bool press(const c3de_event &event);
  bool graspAt(const Snapshot &snapshot, const PickedSurface &picked, const PickRay &ray);
  [[nodiscard]] bool isOnJaw(const Snapshot &snapshot, const PickRay &ray) const;
  [[nodiscard]] GraspSettings settingsOn(const BodySnapshot &body) const;
  void recordMouse(const c3de_event &event, const PickRay &ray);
  [[nodiscard]] Vec3 screenRightAt(const Vec3 &point, const Vec3 &view) const;
  void drag(const PickRay &ray);
  void rotate(const PickRay &ray, double degrees);
  void sendPose();
  void release();
  void clear();
  void detach() override { clear(); }

  GraspSettings settings_;
  bool isChosen_ = false;   // settings_ are set by the user
  bool isPending_ = false;  // grasped, but not yet in a snapshot
  std::optional<Pose> pose_;
  std::optional<Drag> drag_;
  std::optional<MouseSample> previousMouse_, mouse_;  // mouse positions, in this order
  ForceCurve forces_;
  sdk::Proxy arrow_, targetLine_, label_;
};

}  // namespace pointbased
