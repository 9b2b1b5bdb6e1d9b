// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "force_curve.h"
#include "hand_tool.h"

namespace pointbased {

/// Of the rigid sphere or capsule in the hand.
struct InstrumentSettings {
  double radius_mm = 6.0;
  double length_mm = 0.0;  ///< between the middles of the ends; 0: a sphere
  double friction = 0.3;   ///< Coulomb
  bool operator==(const InstrumentSettings &) const = default;
};

/// A rigid instrument that pushes what it meets. Press on a surface: it stands there, outside; drag: it moves parallel
/// to the screen; wheel: deeper and back; release: it stays, and press on it takes hold of it again. In a slice it
/// stands with its middle in the plane, where that is clear of skins, and moves within the plane. An arrow shows the
/// force on it, a label how large it is.
class TouchTool : public HandTool {
 public:
  explicit TouchTool(const Services &services);

  [[nodiscard]] const InstrumentSettings &settings() const { return settings_; }
  /// As a person has set them: an instrument that stands is made anew at its place. Before, the radius is at least the
  /// spacing of what is touched first.
  void setSettings(const InstrumentSettings &settings);

  bool onEvent(const c3de_event &event) override;
  /// Lets go; the instrument stays where it is.
  void cancel() override;

  void moveTo(const Vec3 &middle_m);
  void takeAway();
  /// Markers follow the latest snapshot. Once per frame.
  void update();

  /// Where the hand wants its middle, m; nothing: there is no instrument.
  [[nodiscard]] const std::optional<Vec3> &target() const { return target_; }
  /// On the instrument.
  [[nodiscard]] const ForceCurve &forces() const { return forces_; }

 private:
  struct Drag {
    Vec3 point = Vec3::Zero();   // m, where it was pressed: the hand moves in the plane through it
    Vec3 offset = Vec3::Zero();  // m, from the point under the mouse to the middle
  };
  struct Placing {
    Vec3 middle = Vec3::Zero(), axis = Vec3::UnitZ();  // m, unit
    double radius_mm = 0.0;
  };
  [[nodiscard]] Placing onSurface(const PickedSurface &picked, const PickRay &ray) const;
  [[nodiscard]] std::optional<Placing> inSlice(const Snapshot &snapshot, const PickRay &ray) const;
  bool press(const c3de_event &event);
  void drag(const c3de_event &event);
  void pushAlongView(const c3de_event &event, double way_m);
  void release();
  [[nodiscard]] double radiusOn(const BodySnapshot *body) const;  // mm
  [[nodiscard]] Vec3 halfOf(const Vec3 &axis) const;              // m, from an end of the capsule to its middle
  void place(const Vec3 &middle, const Vec3 &axis);
  void forget();
  void hover();
  void showForce(const ObstacleSnapshot &instrument);
  void leave() override { forget(); }

  InstrumentSettings settings_;
  std::optional<Drag> drag_;
  std::optional<Vec3> target_;
  Vec3 axis_ = Vec3::UnitZ();
  bool isChosen_ = false;   // settings_, by a person
  bool isAwaited_ = false;  // placed, and not yet in a snapshot
  std::optional<c3de_event> hovered_;
  ForceCurve forces_;
  sdk::Proxy ghost_, arrow_, hand_, label_;
};

}  // namespace pointbased
