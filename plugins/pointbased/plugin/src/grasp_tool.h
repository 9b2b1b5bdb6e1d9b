// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "force_curve.h"
#include "hand_tool.h"

namespace pointbased {

/// Two jaws that grasp a fold of tissue. Press on an organ: they take hold on either side and close; drag: they go
/// parallel to the screen; wheel: they turn about the view's axis; release: they stay, and press on one goes on. An
/// arrow shows the pull, a label how large it is and how they squeeze.
class GraspTool : public HandTool {
 public:
  explicit GraspTool(const Services &services) : HandTool(services) {}

  [[nodiscard]] const GraspSettings &settings() const { return settings_; }
  /// As a person has set them, for the next grasp. Before, the jaws are at least two spacings of what is grasped first.
  void setSettings(const GraspSettings &settings);

  bool onEvent(const c3de_event &event) override;
  /// Ends a drag; the jaws stay where they are.
  void cancel() override;
  void letGo();
  /// Markers follow the latest snapshot. Once per frame.
  void update();

  /// Of both jaws together, on the tissue.
  [[nodiscard]] const ForceCurve &forces() const { return forces_; }

 private:
  struct Pose {
    Vec3 middle = Vec3::Zero();
    Mat3 rotation = Mat3::Identity();
  };
  struct Drag {
    Vec3 point = Vec3::Zero();   // m, where it was pressed: the hand moves in the plane through it
    Vec3 offset = Vec3::Zero();  // m, from the point under the mouse to the middle
  };
  struct Seen {
    c3de_event event{};
    PickRay ray;
  };
  bool press(const c3de_event &event);
  bool take(const Snapshot &snapshot, const PickedSurface &picked, const PickRay &ray);
  [[nodiscard]] bool isOnJaw(const Snapshot &snapshot, const PickRay &ray) const;
  [[nodiscard]] GraspSettings settingsOn(const BodySnapshot &body) const;
  void see(const c3de_event &event, const PickRay &ray);
  [[nodiscard]] Vec3 rightOf(const Vec3 &point, const Vec3 &view) const;
  void drag(const PickRay &ray);
  void turn(const PickRay &ray, double degrees);
  void lead();
  void release();
  void forget();
  void leave() override { forget(); }

  GraspSettings settings_;
  bool isChosen_ = false;   // settings_, by a person
  bool isAwaited_ = false;  // taken, and not yet in a snapshot
  std::optional<Pose> pose_;
  std::optional<Drag> drag_;
  std::optional<Seen> before_, seen_;  // places of the mouse, in this order
  ForceCurve forces_;
  sdk::Proxy arrow_, hand_, label_;
};

}  // namespace pointbased
