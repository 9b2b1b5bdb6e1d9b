// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tools/force_curve.h"
#include "tools/interactive_tool.h"

namespace pointbased {

/// Settings of the interactive rigid sphere or capsule.
struct InstrumentSettings {
  double radius_mm = 6.0;
  double length_mm = 0.0;  ///< between the centres of the ends; 0: a sphere
  double friction = 0.3;   ///< Coulomb
  bool operator==(const InstrumentSettings &) const = default;
};

/// A rigid instrument that pushes whatever it touches. Press on a surface: the instrument is placed there, outside.
/// Drag: it moves parallel to the screen. Wheel: it moves deeper and back. Release: it stays, and a press on it resumes
/// the drag. In a slice its middle is placed in the slice plane, clear of skins, and it moves within the plane. An
/// arrow shows the force on it, a label its magnitude.
class TouchTool : public InteractiveTool {
 public:
  TouchTool(const Services &services, std::shared_ptr<InteractionSteps> steps);

  [[nodiscard]] const InstrumentSettings &settings() const { return settings_; }
  /// Settings chosen by the user: an existing instrument is recreated at its position. Until set, the radius is at
  /// least the spacing of the first touched body.
  void setSettings(const InstrumentSettings &settings);

  bool onEvent(const c3de_event &event) override;
  /// Ends a drag; the instrument stays at its position.
  void cancel() override;

  void moveTo(const Vec3 &middle_m);
  void removeInstrument();
  /// Markers follow the latest snapshot. Called once per frame.
  void update();

  /// Target position of its middle, m; nothing if there is no instrument.
  [[nodiscard]] const std::optional<Vec3> &target() const { return target_; }
  /// Force on the instrument.
  [[nodiscard]] const ForceCurve &forces() const { return forces_; }

 private:
  struct Drag {
    Vec3 point = Vec3::Zero();   // m, where the button was pressed: the drag moves in the plane through it
    Vec3 offset = Vec3::Zero();  // m, from the point under the mouse to the middle
  };
  struct InstrumentPose {
    Vec3 middle = Vec3::Zero(), axis = Vec3::UnitZ();  // m, unit
    double radius_mm = 0.0;
  };
  [[nodiscard]] InstrumentPose onSurface(const PickedSurface &picked, const PickRay &ray) const;
  [[nodiscard]] std::optional<InstrumentPose> inSlice(const Snapshot &snapshot, const PickRay &ray) const;
  bool press(const c3de_event &event);
  void drag(const c3de_event &event);
  void pushAlongView(const c3de_event &event, double distance_m);
  void release();
  [[nodiscard]] double radiusOn(const BodySnapshot *body) const;  // mm
  [[nodiscard]] Vec3 halfAxis(const Vec3 &axis) const;            // m, from an end of the capsule to its middle
  void placeInstrument(const Vec3 &middle, const Vec3 &axis);
  void clear();
  void showPreview();
  void showForce(const ObstacleSnapshot &instrument);
  void detach() override { clear(); }

  InstrumentSettings settings_;
  std::optional<Drag> drag_;
  std::optional<Vec3> target_;
  Vec3 axis_ = Vec3::UnitZ();
  bool isChosen_ = false;   // settings_ are set by the user
  bool isPending_ = false;  // placed, but not yet in a snapshot
  std::optional<c3de_event> hovered_;
  ForceCurve forces_;
  sdk::Proxy preview_, arrow_, targetLine_, label_;
};

}  // namespace pointbased
