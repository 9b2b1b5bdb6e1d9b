// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tools/interactive_tool.h"

namespace pointbased {

/// Pose of an obstacle: its middle, and its rotation from rest.
struct ObstaclePose {
  Vec3 middle = Vec3::Zero();  ///< m
  Mat3 rotation = Mat3::Identity();

  [[nodiscard]] RigidMotion motionFrom(const Vec3 &middleAtRest) const {
    return {rotation, middleAtRest, middle - middleAtRest};
  }
};
/// Degrees about x, then y, then z.
[[nodiscard]] Vec3 anglesOf(const Mat3 &rotation);
[[nodiscard]] Mat3 rotationOf(const Vec3 &angles_deg);

/// Places implants, plates and other obstacles interactively. Press on one: it is chosen, and drag moves it parallel to
/// the screen. Its arrows move it along x, y and z, its rings turn it. An obstacle that the scene moves cannot be
/// moved.
class MoveTool : public InteractiveTool {
 public:
  MoveTool(const Services &services, std::shared_ptr<InteractionSteps> steps);

  bool onEvent(const c3de_event &event) override;
  void cancel() override;
  /// Handles follow the latest snapshot. Called once per frame.
  void update();

  /// The chosen obstacle; 0 if none.
  [[nodiscard]] std::uint64_t chosen() const { return chosen_; }
  void choose(std::uint64_t obstacle);
  /// Target pose; nothing if no obstacle is chosen.
  [[nodiscard]] const std::optional<ObstaclePose> &pose() const { return pose_; }
  /// Sets the pose by numbers. All changes until commit() are one undo step.
  void setPose(const ObstaclePose &pose);
  void commit();

 private:
  enum class Handle { free, along, about };
  struct Drag {
    Handle handle = Handle::free;
    int axis = 0;
    Vec3 point = Vec3::Zero();  // m, where the handle was pressed
    ObstaclePose from;
  };
  bool press(const c3de_event &event);
  void drag(const PickRay &ray);
  [[nodiscard]] std::optional<Drag> handleUnder(const PickRay &ray) const;
  [[nodiscard]] const ObstacleSnapshot *chosenObstacle(const std::shared_ptr<const Snapshot> &snapshot) const;
  void detach() override { choose(0); }
  void sendPose();
  void showHandles();
  void hideHandles();

  std::uint64_t chosen_ = 0;
  std::string name_;
  Vec3 middleAtRest_ = Vec3::Zero();
  double size_ = 0.02;  // m, of the handles
  std::optional<ObstaclePose> pose_;
  std::optional<Drag> drag_;
  bool isEdited_ = false;    // by numbers, since commit()
  bool isMoving_ = false;    // the obstacle has not reached its target pose yet
  std::uint64_t steps_ = 0;  // of the last snapshot
  std::array<sdk::Proxy, 3> arrows_, rings_;
  sdk::Proxy label_;
};

}  // namespace pointbased
