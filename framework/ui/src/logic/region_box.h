// SPDX-License-Identifier: Apache-2.0
// A region of a scan as a box that is dragged by its sides, and its position in slices. No drawing.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "c3de/ui/slice_view.h"

namespace c3de::ui {

/// Corners of a box along the axes of the patient, the low one first; LPS, mm.
using Box = std::array<Vec3, 2>;

/// What a drag changes about a box.
struct BoxGrip {
  enum class Kind {
    sides,  ///< -1: the low side of an axis, 1: the high side
    whole,  ///< the box moves along the axes that are not 0
    drawn   ///< a new box along the axes that are not 0, from where the drag begins
  };
  Kind kind = Kind::drawn;
  std::array<int, 3> sides{};
  friend bool operator==(const BoxGrip &, const BoxGrip &) = default;
};

/// A box that stays within limits and has a minimum width. Drags are undo and redo steps. Dragged sides snap to round
/// numbers, finer than a fifth of the least width. Value type.
class RegionBox {
 public:
  /// @param least_mm  along each axis, > 0
  /// @param box       sorted and clamped to the limits; none: the limits themselves
  RegionBox(const Box &limits, const Vec3 &least_mm, const std::optional<Box> &box = {});

  [[nodiscard]] const Box &box() const { return box_; }
  [[nodiscard]] const Box &limits() const { return limits_; }
  [[nodiscard]] Vec3 size_mm() const { return box_[1] - box_[0]; }
  [[nodiscard]] double volume_ml() const;
  /// Whether it could move along an axis.
  [[nodiscard]] bool hasRoom(std::size_t axis) const;

  /// A drag, from and to points of the world.
  void begin(const BoxGrip &grip, const Vec3 &at);
  void dragTo(const Vec3 &at);
  void finish();
  void takeBack();
  /// The current drag; null if there is none.
  [[nodiscard]] const BoxGrip *grip() const { return drag_ ? &drag_->grip : nullptr; }

  // Not during a drag.
  void takeAll();  ///< expands to the limits, as a step
  void undo();
  void redo();
  [[nodiscard]] bool canUndo() const { return !undo_.empty(); }
  [[nodiscard]] bool canRedo() const { return !redo_.empty(); }

 private:
  struct Drag {
    BoxGrip grip;
    Vec3 from;
    Box before;
  };
  [[nodiscard]] double rounded(double value) const;
  void keep(const Box &before);

  Box limits_, box_;
  Vec3 least_mm_;
  double perMillimetre_;  ///< of the round numbers
  std::optional<Drag> drag_;
  std::vector<Box> undo_, redo_;
};

/// Position of a box in a view along the axes of the patient: pixels from the view's upper left corner.
struct BoxInSlice {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  bool isCut = false;  ///< the slice intersects it; otherwise it is in front of or behind the slice
};
[[nodiscard]] BoxInSlice boxInSlice(const SliceView &view, const Box &box);

/// A handle to drag in a slice.
struct BoxHandle {
  const char *name;  ///< "top_left", …, "middle"
  BoxGrip grip;
  double x = 0.0, y = 0.0;
};
/// Corners, the middles of the visible parts of the edges, and the middle if the box can move. If there is not enough
/// space for three in a row, only the corners.
/// @param size_px  of a handle
[[nodiscard]] std::vector<BoxHandle> boxHandles(const SliceView &view, const RegionBox &box, double size_px);

/// What a drag that begins at a pixel would do: move a near handle, move the box (inside and on its outline), otherwise
/// draw a new one. If the box cannot move in the slice, a new one is also drawn inside it.
[[nodiscard]] BoxGrip gripAt(const SliceView &view, const RegionBox &box, double size_px, double x, double y);

/// Direction in which a grip moves on the screen, -1, 0, 1 to the right and down.
[[nodiscard]] std::array<int, 2> directionOf(const SliceView &view, const BoxGrip &grip);

}  // namespace c3de::ui
