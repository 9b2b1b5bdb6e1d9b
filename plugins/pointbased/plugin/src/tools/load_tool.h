// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>

#include "tools/interactive_tool.h"

namespace pointbased {

/// Selects a part of the surface of a body for a support or a load, and shows those that are set. Brush: press and drag
/// on the surface or in a slice paints; the wheel, [ and ] change the radius. Face: a click selects the connected
/// surface whose normal deviates by less than an angle from that of the point. E switches between adding to the
/// selection and removing from it.
class LoadTool : public InteractiveTool {
 public:
  LoadTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
      : InteractiveTool(services, std::move(steps)) {}

  bool onEvent(const c3de_event &event) override;
  void cancel() override { isPainting_ = false; }
  /// Highlights and arrows follow the latest snapshot. Called once per frame.
  void update();

  enum class Mode : std::uint32_t { brush, face };
  Mode mode = Mode::brush;
  bool isRemoving = false;                                       ///< from the selection
  double radius_mm = 5.0;                                        ///< of the brush, kMinRadius … kMaxRadius
  double angle_deg = 25.0;                                       ///< of a face, 0 … 180
  static constexpr double kMinRadius = 0.2, kMaxRadius = 200.0;  ///< mm

  /// Part of the surface that is selected; empty if none. @param snapshot  of the simulator
  [[nodiscard]] SurfacePatch patch(const Snapshot &snapshot) const;
  [[nodiscard]] std::uint64_t body() const { return body_; }
  [[nodiscard]] std::size_t triangles() const { return selected_.size(); }
  void clear();
  /// Conditions that are not drawn, by number.
  std::set<std::uint64_t> hidden;

 private:
  void detach() override;
  void paint(const c3de_event &event);
  void paintAround(const BodySnapshot &body, const Vec3 &at, const std::optional<Vec3> &normal);
  void selectFace(std::uint32_t triangle);
  void select(std::uint32_t triangle);
  void choose(const BodySnapshot &body);
  void showSelection(const Snapshot *snapshot);
  struct Shown {
    sdk::Proxy patch, arrow, label;
    std::size_t triangles = 0;
    void reset() {
      patch.reset();
      arrow.reset();
      label.reset();
    }
  };
  void showCondition(const ConditionSnapshot &one, Shown &shown);

  std::uint64_t body_ = 0;                     // of the selection
  std::shared_ptr<const PlacedMesh> surface_;  // to which the triangles belong
  std::set<std::uint32_t> selected_;
  std::size_t shownTriangles_ = 0;
  bool isPainting_ = false, isChanged_ = false;
  sdk::Proxy highlight_;
  std::map<std::uint64_t, Shown> shown_;
};

}  // namespace pointbased
