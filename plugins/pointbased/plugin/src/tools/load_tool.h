// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>

#include "tools/box_selection.h"
#include "tools/condition_edits.h"
#include "tools/condition_marks.h"
#include "tools/interactive_tool.h"

namespace pointbased {

/// Selects a part of the surface of a body for a support or a load, shows those that are set, and changes their values
/// by the handles at the tips of their arrows.
/// Brush: press and drag paints. Face: a click selects the connected surface up to its edges. Box: a rectangle selects
/// what is visible in it, or in a slice what is near the plane. All of them add to the selection; with E or Alt they
/// remove from it. Escape cancels what is being dragged.
class LoadTool : public InteractiveTool {
 public:
  LoadTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
      : InteractiveTool(services, std::move(steps)), edits_(services, simulator_), marks_(services) {}

  bool onEvent(const c3de_event &event) override;
  void cancel() override;
  /// Highlights and arrows follow the latest snapshot. Called once per frame.
  /// @param view  of the simulator; null if there is none
  void update(const SimulatorView *view);

  enum class Mode : std::uint32_t { brush, face, box };
  Mode mode = Mode::brush;
  bool isRemoving = false;                 ///< from the selection
  double radius_mm = 5.0;                  ///< of the brush, kMinRadius … kMaxRadius
  FaceBorder border = FaceBorder::crease;  ///< where a face ends
  double angle_deg = 25.0;                 ///< of a face, kMinAngle … kMaxAngle
  bool through = false;                    ///< box in 3D: also the far side
  double depth_mm = 2.0;                   ///< box in a slice: to each side of its plane, kMinDepth … kMaxDepth
  static constexpr double kMinRadius = 0.2, kMaxRadius = 200.0;  ///< mm
  static constexpr double kMinAngle = 1.0, kMaxAngle = 90.0;     ///< degrees
  static constexpr double kMinDepth = 0.1, kMaxDepth = 200.0;    ///< mm

  /// Part of the surface that is selected; empty if none. @param snapshot  of the simulator
  [[nodiscard]] SurfacePatch patch(const Snapshot &snapshot) const;
  [[nodiscard]] std::uint64_t body() const { return body_; }
  [[nodiscard]] std::size_t triangles() const { return selected_.size(); }
  void clear();
  /// About the last selection, for the user: what was not selected, and why; empty: nothing.
  [[nodiscard]] const std::string &note() const { return note_; }
  /// Name and value of the condition whose arrow is being dragged: "Force 2: 1.25 N"; empty: none.
  [[nodiscard]] std::string draggedText() const;

  [[nodiscard]] ConditionEdits &edits() { return edits_; }
  [[nodiscard]] ConditionMarks &marks() { return marks_; }

 private:
  using Selected = std::set<std::uint32_t>;
  enum class Gesture { none, brush, face, box, arrow };
  struct ArrowDrag {
    std::uint64_t number = 0;
    SurfaceCondition before, value;
    ConditionArrow arrow;        // at the press
    Vec3 offset = Vec3::Zero();  // m, from the pressed point to the tip
    bool isSlice = false;
  };
  /// The selection before a gesture, which Escape restores.
  struct Before {
    std::uint64_t body = 0;
    std::shared_ptr<const PlacedMesh> surface;
    Selected selected;
  };
  void detach() override;
  bool press(const c3de_event &event);
  void move(const c3de_event &event);
  void release(const c3de_event &event);
  bool pressKey(std::uint32_t key);
  void changeSize(double notches);
  bool beginArrow(const Snapshot &snapshot, const PickRay &ray, bool isSlice);
  void dragArrow(const PickRay &ray);
  void commitArrow();
  void paint(const c3de_event &event);
  void paintAround(const BodySnapshot &body, const Vec3 &at, const std::optional<Vec3> &normal);
  void selectFace(std::uint32_t triangle);
  void takeBox();
  void endBox();
  void select(std::uint32_t triangle);
  void setRemoving(const c3de_event &event);
  void choose(const BodySnapshot &body);
  void choose(std::uint64_t body, const std::shared_ptr<const PlacedMesh> &surface);
  void showSelection(const Snapshot *snapshot);
  void showBox();
  void forgetRemovedBody(const Snapshot *snapshot);

  ConditionEdits edits_;
  ConditionMarks marks_;
  std::uint64_t body_ = 0;                     // of the selection
  std::shared_ptr<const PlacedMesh> surface_;  // to which the triangles belong
  Selected selected_;
  std::shared_ptr<const PlacedMesh> neighboursOf_;
  std::optional<TriangleNeighbours> neighbours_;
  Gesture gesture_ = Gesture::none;
  Before before_;
  bool removesNow_ = false;  // in the gesture
  std::optional<BoxSelection> box_;
  bool isBoxReleased_ = false;
  std::optional<ArrowDrag> arrow_;
  std::string note_;
  bool isChanged_ = false;
  sdk::Proxy highlight_, outline_;
};

}  // namespace pointbased
