// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/slice_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/core/text.h"

namespace c3de::ui {
namespace {

constexpr double kSecondLetter = 0.1, kZoomPerStep = 0.9, kMargin = 1.04;
constexpr double kFinest_mm = 1e-4, kCoarsest_mm = 1e4;  // per pixel

Vec3 unit(const Vec3 &v) { return (1.0 / norm(v)) * v; }
Vec3 column(const Mat4 &m, std::size_t c) { return {m[4 * c], m[4 * c + 1], m[4 * c + 2]}; }

/// Right-handed directions along the index axes of a grid that are nearest to x, y, z.
std::array<Vec3, 3> axesOf(const imaging::VolumeGeometry &grid) {
  std::array<Vec3, 3> index{};
  index[0] = unit(column(grid.indexToWorld, 0));
  const Vec3 second = column(grid.indexToWorld, 1);
  index[1] = unit(second - dot(second, index[0]) * index[0]);
  index[2] = cross(index[0], index[1]);
  std::array<std::size_t, 3> order{0, 1, 2}, best = order;
  double most = -1.0;
  do {
    double sum = 0.0;
    for (std::size_t a = 0; a < 3; ++a) sum += std::abs(index[order[a]][a]);
    if (sum > most + 1e-9) {
      most = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  std::array<Vec3, 3> axes{};
  for (std::size_t a = 0; a < 3; ++a) axes[a] = (index[best[a]][a] < 0.0 ? -1.0 : 1.0) * index[best[a]];
  // The third axis follows from the other two, so that the frame is never mirrored.
  if (dot(cross(axes[0], axes[1]), axes[2]) < 0.0) axes[2] = -1.0 * axes[2];
  return axes;
}

}  // namespace

SliceFrame sliceFrame(SliceAxis axis, Convention convention, const imaging::VolumeGeometry *alignedWith) {
  const std::array<Vec3, 3> axes =
      alignedWith ? axesOf(*alignedWith) : std::array<Vec3, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const Vec3 &left = axes[0], &back = axes[1], &up = axes[2];
  const Vec3 across = convention == Convention::radiological ? left : -1.0 * left;
  switch (axis) {
    case SliceAxis::axial: return {across, back, up};
    case SliceAxis::coronal: return {across, -1.0 * up, -1.0 * back};
    default: return {back, -1.0 * up, left};
  }
}

double voxelStep(const imaging::VolumeGeometry &grid, const Vec3 &direction) {
  const Mat4 inverse = imaging::affineInverse(grid.indexToWorld);
  double fastest = 0.0;
  for (std::size_t r = 0; r < 3; ++r)
    fastest = std::max(
        fastest, std::abs(inverse[r] * direction[0] + inverse[4 + r] * direction[1] + inverse[8 + r] * direction[2]));
  return 1.0 / fastest;
}

std::string orientationLetters(const Vec3 &direction) {
  static constexpr const char *kLetters[3][2] = {{"R", "L"}, {"A", "P"}, {"I", "S"}};
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(direction[a]) > std::abs(direction[b]) + 1e-9;
  });
  const double length = norm(direction);
  if (!(length > 0.0)) return {};
  std::string text;
  for (std::size_t k = 0; k < 2; ++k) {
    const double part = direction[order[k]] / length;
    if (k > 0 && std::abs(part) <= kSecondLetter) break;
    text += kLetters[order[k]][part > 0.0 ? 1 : 0];
  }
  return text;
}

ScaleBar scaleBar(double millimetresPerPixel, double longest_px) {
  const double longest_mm = millimetresPerPixel * longest_px;
  if (!(longest_mm > 0.0) || !std::isfinite(longest_mm)) return {};
  const double power = std::pow(10.0, std::floor(std::log10(longest_mm)));
  double length = power;
  for (const double factor : {2.0, 5.0})
    if (factor * power <= longest_mm * (1.0 + 1e-12)) length = factor * power;
  ScaleBar bar{length, length / millimetresPerPixel, {}};
  if (length >= 10.0)
    bar.text = formatNumber(length / 10.0) + " cm";
  else if (length >= 1.0)
    bar.text = formatNumber(length) + " mm";
  else
    bar.text = formatNumber(std::round(length * 1e6) / 1e3) + " µm";
  return bar;
}

void SliceView::setGrid(const imaging::VolumeGeometry &grid) {
  grid_ = grid;
  countSlices();
}

void SliceView::setFrame(const SliceFrame &frame) {
  frame_ = frame;
  countSlices();
  showPoint(centre_);
  if (isFitted_) fit();
}

void SliceView::countSlices() {
  step_ = voxelStep(grid_, frame_.forward);
  double low = 1e300, high = -1e300;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (corner >> a & 1u) != 0 ? static_cast<double>(grid_.size[a] - 1) : 0.0;
    const double at = dot(grid_.worldAt(index), frame_.forward);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  first_ = low;
  count_ = static_cast<int>(std::floor((high - low) / step_ + 0.5)) + 1;
}

Vec3 SliceView::gridCentre() const {
  Vec3 index{};
  for (std::size_t a = 0; a < 3; ++a) index[a] = 0.5 * static_cast<double>(grid_.size[a] - 1);
  return grid_.worldAt(index);
}

double SliceView::fittedScale() const {
  Vec3 lowest{1e300, 1e300, 0}, highest{-1e300, -1e300, 0};
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (corner >> a & 1u) != 0 ? static_cast<double>(grid_.size[a]) - 0.5 : -0.5;
    const Vec3 world = grid_.worldAt(index), at{dot(world, frame_.right), dot(world, frame_.down), 0};
    for (std::size_t a = 0; a < 2; ++a) {
      lowest[a] = std::min(lowest[a], at[a]);
      highest[a] = std::max(highest[a], at[a]);
    }
  }
  return kMargin * std::max((highest[0] - lowest[0]) / width_, (highest[1] - lowest[1]) / height_);
}

void SliceView::setSize(int width, int height) {
  width = std::max(width, 1);
  height = std::max(height, 1);
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  if (isFitted_) fit();
}

void SliceView::fit() {
  const Vec3 middle = gridCentre();
  centre_ = middle + (position() - dot(middle, frame_.forward)) * frame_.forward;
  millimetresPerPixel_ = fittedScale();
  isFitted_ = true;
}

void SliceView::reset() {
  centre_ = gridCentre();
  showSlice((count_ - 1) / 2);
  fit();
}

Vec3 SliceView::worldAt(double x, double y) const {
  return centre_ + (millimetresPerPixel_ * (x - 0.5 * width_)) * frame_.right +
         (millimetresPerPixel_ * (y - 0.5 * height_)) * frame_.down;
}

SliceView::Pixel SliceView::pixelOf(const Vec3 &world) const {
  const Vec3 p = world - centre_;
  return {0.5 * width_ + dot(p, frame_.right) / millimetresPerPixel_,
          0.5 * height_ + dot(p, frame_.down) / millimetresPerPixel_};
}

render::SlicePlane SliceView::plane() const {
  return {worldAt(0, 0), millimetresPerPixel_ * frame_.right, millimetresPerPixel_ * frame_.down};
}

int SliceView::slice() const {
  return std::clamp(static_cast<int>(std::lround((position() - first_) / step_)), 0, count_ - 1);
}

void SliceView::scroll(int slices) { showSlice(slice() + slices); }

void SliceView::showSlice(int slice) {
  const double wanted = first_ + step_ * std::clamp(slice, 0, count_ - 1);
  centre_ = centre_ + (wanted - position()) * frame_.forward;
}

void SliceView::showPoint(const Vec3 &world) {
  const double number = (dot(world, frame_.forward) - first_) / step_;
  showSlice(static_cast<int>(std::lround(std::clamp(number, -1.0, static_cast<double>(count_)))));
}

bool SliceView::isOnSlice(const Vec3 &world) const {
  return std::abs(dot(world, frame_.forward) - position()) <= 0.5 * step_ + 1e-6;
}

void SliceView::zoom(double steps, double x, double y) {
  const Vec3 under = worldAt(x, y);
  millimetresPerPixel_ = std::clamp(millimetresPerPixel_ * std::pow(kZoomPerStep, steps), kFinest_mm, kCoarsest_mm);
  centre_ = centre_ + (under - worldAt(x, y));
  isFitted_ = false;
}

void SliceView::magnify(double factor) {
  if (!(factor > 0.0)) return;
  millimetresPerPixel_ = std::clamp(millimetresPerPixel_ / factor, kFinest_mm, kCoarsest_mm);
  isFitted_ = false;
}

void SliceView::pan(double dx_px, double dy_px) {
  centre_ = centre_ - (dx_px * millimetresPerPixel_) * frame_.right - (dy_px * millimetresPerPixel_) * frame_.down;
  isFitted_ = false;
}

}  // namespace c3de::ui
