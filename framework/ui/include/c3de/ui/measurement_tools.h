// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/registry/tool_registry.h"
#include "c3de/render/camera.h"
#include "c3de/ui/measurement_list.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::ui {

class ImageViews;

/// A point that a user has clicked: an existing one, or a new one.
struct MeasurementPick {
  std::string name;  ///< of an existing point; empty: new
  Vec3 at_mm{};
  bool isAtRest = false;  ///< at_mm is a position at rest, because the image is shown as it was read
};

/// The tools Landmark, Distance and Angle. A click places a point, or uses the point under the mouse. Dragging moves a
/// point (Landmark), or places the second one (Distance). After placeTargetOf() the next click places the target of a
/// landmark. Main thread.
class MeasurementTools {
 public:
  struct Parts {
    MeasurementList &list;
    const ImageViews *images = nullptr;            ///< null: there is only the 3D view
    const render::Renderer *renderer = nullptr;    ///< whose surfaces are clicked; null: none
    std::function<double(const Vec3 &)> space_mm;  ///< mm per pixel of the 3D view at a point
    /// All points of a measurement have been clicked.
    std::function<void(MeasureKind, std::vector<MeasurementPick>)> placed;
    std::function<void(const std::string &name, const MeasurementPick &)> moved;
    std::function<void(const std::string &name)> removed;
    /// The target of a landmark was clicked, in the world of the open image.
    std::function<void(const std::string &name, const Vec3 &at_mm, bool isInSlice)> targeted;
  };
  explicit MeasurementTools(Parts parts) : parts_(std::move(parts)) {}
  MeasurementTools(const MeasurementTools &) = delete;
  MeasurementTools &operator=(const MeasurementTools &) = delete;

  /// Registers the three tools; both must outlive their use.
  void addTo(registry::ToolRegistry &tools);

  /// Activates the tool Landmark, whose next click is the target of this landmark. Escape and other tools cancel it.
  void placeTargetOf(const std::string &name);
  /// The landmark whose target is placed next; empty: none.
  [[nodiscard]] const std::string &targetOf() const { return targetOf_; }

  /// Points of the unfinished measurement, and the point under the mouse that would follow.
  [[nodiscard]] const std::vector<MeasurementPick> &pending() const { return pending_; }
  [[nodiscard]] std::optional<Vec3> follower() const { return follower_; }
  /// The point being dragged, and its position.
  [[nodiscard]] std::optional<std::pair<std::string, Vec3>> dragged() const;
  /// Where a point is shown: at rest while the slices show the image as it was read.
  [[nodiscard]] Vec3 shownAt(const MeasuredPoint &point, bool isInSlice) const;

  static constexpr double kReach_px = 9.0, kDrag_px = 5.0;

 private:
  struct Tool {
    MeasurementTools *all;
    MeasureKind kind;
  };
  [[nodiscard]] bool handle(MeasureKind kind, const c3de_event &event);
  [[nodiscard]] bool press(MeasureKind kind, const c3de_event &event);
  void release(MeasureKind kind, const c3de_event &event);
  void move(const c3de_event &event);
  void cancel();
  void add(MeasureKind kind, MeasurementPick pick);
  [[nodiscard]] bool showsRest(const c3de_event &event) const;
  /// The point of the tissue under the mouse; none: there is nothing.
  [[nodiscard]] std::optional<Vec3> locate(const c3de_event &event) const;
  /// Same, in the plane of a point where the ray hits nothing or is not a press.
  [[nodiscard]] Vec3 inPlaneOf(const Vec3 &point, const c3de_event &event) const;
  [[nodiscard]] const MeasuredPoint *under(const c3de_event &event) const;

  Parts parts_;
  registry::ToolRegistry *registry_ = nullptr;
  Handle landmarkTool_;
  std::string targetOf_;
  std::array<Tool, 3> tools_{};
  std::vector<MeasurementPick> pending_;
  std::optional<Vec3> follower_;
  std::string draggedName_;
  Vec3 draggedAt_{};
  bool hasDragged_ = false, isDown_ = false;
  double pressX_ = 0.0, pressY_ = 0.0;
};

}  // namespace c3de::ui
