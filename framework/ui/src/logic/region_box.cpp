// SPDX-License-Identifier: Apache-2.0
#include "logic/region_box.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace c3de::ui {
namespace {

constexpr double kReach = 0.75;      // of a handle, from its centre, in sizes of a handle
constexpr double kLineReach = 0.35;  // of the outline, in sizes of a handle
constexpr double kRoomForHandles = 3.0;
constexpr double kSame_mm = 1e-6;

struct SliceAxes {
  std::size_t right, down, forward;
  int rightSign, downSign;
};

std::size_t axisOf(const Vec3 &direction) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(direction[a]) > std::abs(direction[axis])) axis = a;
  return axis;
}

SliceAxes axesOf(const SliceFrame &frame) {
  const std::size_t right = axisOf(frame.right), down = axisOf(frame.down);
  return {right, down, axisOf(frame.forward), frame.right[right] < 0.0 ? -1 : 1, frame.down[down] < 0.0 ? -1 : 1};
}

}  // namespace

RegionBox::RegionBox(const Box &limits, const Vec3 &least_mm, const std::optional<Box> &box)
    : limits_(limits), box_(box.value_or(limits)), least_mm_(least_mm) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = limits_[0][a], high = limits_[1][a];
    least_mm_[a] = std::min(least_mm_[a], high - low);
    if (box_[0][a] > box_[1][a]) std::swap(box_[0][a], box_[1][a]);
    box_[0][a] = std::clamp(box_[0][a], low, high - least_mm_[a]);
    box_[1][a] = std::clamp(box_[1][a], box_[0][a] + least_mm_[a], high);
  }
  const double finest_mm = 0.2 * std::min({least_mm_[0], least_mm_[1], least_mm_[2]});
  perMillimetre_ = finest_mm > 0.0 ? std::pow(10.0, std::max(0.0, std::ceil(-std::log10(finest_mm) - 1e-9))) : 1.0;
}

double RegionBox::rounded(double value) const { return std::round(value * perMillimetre_) / perMillimetre_; }

double RegionBox::volume_ml() const {
  const Vec3 size = size_mm();
  return 1e-3 * size[0] * size[1] * size[2];
}

bool RegionBox::hasRoom(std::size_t axis) const {
  return size_mm()[axis] < limits_[1][axis] - limits_[0][axis] - kSame_mm;
}

void RegionBox::begin(const BoxGrip &grip, const Vec3 &at) { drag_ = Drag{grip, at, box_}; }

void RegionBox::dragTo(const Vec3 &at) {
  if (!drag_) return;
  const Box &before = drag_->before;
  for (std::size_t a = 0; a < 3; ++a) {
    const int side = drag_->grip.sides[a];
    if (side == 0) continue;
    const double lowest = limits_[0][a], highest = limits_[1][a], least = least_mm_[a], by = at[a] - drag_->from[a];
    double &low = box_[0][a], &high = box_[1][a];
    switch (drag_->grip.kind) {
      case BoxGrip::Kind::sides:
        if (side < 0)
          low = std::clamp(rounded(before[0][a] + by), lowest, high - least);
        else
          high = std::clamp(rounded(before[1][a] + by), low + least, highest);
        break;
      case BoxGrip::Kind::whole: {
        const double width = before[1][a] - before[0][a];
        low = std::clamp(rounded(before[0][a] + by), lowest, highest - width);
        high = low + width;
        break;
      }
      case BoxGrip::Kind::drawn: {
        const double from = rounded(drag_->from[a]), to = rounded(at[a]);
        low = std::clamp(std::min(from, to), lowest, highest);
        high = std::clamp(std::max(from, to), lowest, highest);
        if (high - low >= least) break;
        if (to < from) low = high - least;
        low = std::clamp(low, lowest, highest - least);
        high = low + least;
        break;
      }
    }
  }
}

void RegionBox::keep(const Box &before) {
  if (box_ == before) return;
  undo_.push_back(before);
  redo_.clear();
}

void RegionBox::finish() {
  if (drag_) keep(std::exchange(drag_, {})->before);
}

void RegionBox::takeBack() {
  if (drag_) box_ = std::exchange(drag_, {})->before;
}

void RegionBox::takeAll() { keep(std::exchange(box_, limits_)); }

void RegionBox::undo() {
  if (undo_.empty()) return;
  redo_.push_back(std::exchange(box_, undo_.back()));
  undo_.pop_back();
}

void RegionBox::redo() {
  if (redo_.empty()) return;
  undo_.push_back(std::exchange(box_, redo_.back()));
  redo_.pop_back();
}

BoxInSlice boxInSlice(const SliceView &view, const Box &box) {
  const SliceView::Pixel p = view.pixelOf(box[0]), q = view.pixelOf(box[1]);
  const std::size_t forward = axesOf(view.frame()).forward;
  const double at = view.worldAt(0, 0)[forward];
  return {std::min(p.x, q.x), std::min(p.y, q.y), std::max(p.x, q.x), std::max(p.y, q.y),
          at >= box[0][forward] && at <= box[1][forward]};
}

std::vector<BoxHandle> boxHandles(const SliceView &view, const RegionBox &box, double size_px) {
  static constexpr const char *kNames[3][3] = {
      {"top_left", "top", "top_right"}, {"left", "middle", "right"}, {"bottom_left", "bottom", "bottom_right"}};
  const SliceAxes axes = axesOf(view.frame());
  const BoxInSlice at = boxInSlice(view, box.box());
  const double middleX = 0.5 * (std::max(at.left, 0.0) + std::min(at.right, static_cast<double>(view.width())));
  const double middleY = 0.5 * (std::max(at.top, 0.0) + std::min(at.bottom, static_cast<double>(view.height())));
  const double xs[] = {at.left, middleX, at.right}, ys[] = {at.top, middleY, at.bottom};
  const bool isWide = at.right - at.left >= kRoomForHandles * size_px,
             isHigh = at.bottom - at.top >= kRoomForHandles * size_px;
  std::vector<BoxHandle> handles;
  for (int v = -1; v <= 1; ++v)
    for (int h = -1; h <= 1; ++h) {
      if ((h == 0 && !isWide) || (v == 0 && !isHigh)) continue;
      BoxHandle handle{kNames[v + 1][h + 1], {BoxGrip::Kind::sides, {}}, xs[h + 1], ys[v + 1]};
      handle.grip.sides[axes.right] = h * axes.rightSign;
      handle.grip.sides[axes.down] = v * axes.downSign;
      if (h == 0 && v == 0) {
        if (!box.hasRoom(axes.right) && !box.hasRoom(axes.down)) continue;
        handle.grip.kind = BoxGrip::Kind::whole;
        handle.grip.sides[axes.right] = handle.grip.sides[axes.down] = 1;
      }
      handles.push_back(handle);
    }
  return handles;
}

BoxGrip gripAt(const SliceView &view, const RegionBox &box, double size_px, double x, double y) {
  const auto distance = [&](const BoxHandle &h) { return std::max(std::abs(h.x - x), std::abs(h.y - y)); };
  const std::vector<BoxHandle> handles = boxHandles(view, box, size_px);
  const auto nearest = std::min_element(handles.begin(), handles.end(), [&](const BoxHandle &a, const BoxHandle &b) {
    return distance(a) < distance(b);
  });
  if (distance(*nearest) <= kReach * size_px) return nearest->grip;
  const SliceAxes axes = axesOf(view.frame());
  const BoxInSlice at = boxInSlice(view, box.box());
  const double reach = kLineReach * size_px;
  const bool isInside = x >= at.left - reach && x <= at.right + reach && y >= at.top - reach && y <= at.bottom + reach;
  BoxGrip grip;
  grip.sides[axes.right] = grip.sides[axes.down] = 1;
  if (isInside && (box.hasRoom(axes.right) || box.hasRoom(axes.down))) grip.kind = BoxGrip::Kind::whole;
  return grip;
}

std::array<int, 2> directionOf(const SliceView &view, const BoxGrip &grip) {
  const SliceAxes axes = axesOf(view.frame());
  return {grip.sides[axes.right] * axes.rightSign, grip.sides[axes.down] * axes.downSign};
}

}  // namespace c3de::ui
