// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "pointbased/types.h"

namespace pointbased {

/// A pixel of a view, and the ray through it; m, unit direction.
struct PixelRay {
  double x = 0.0, y = 0.0;  ///< px, from the upper left corner of the view
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();
};

/// A rectangle of a view, px.
struct PixelRect {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;

  [[nodiscard]] static PixelRect between(const PixelRay &a, const PixelRay &b);
  [[nodiscard]] bool contains(double x, double y) const { return x >= left && x <= right && y >= top && y <= bottom; }
};

/// How the pixels of a view map to space, in perspective or parallel. Pixels are square and the view is not mirrored.
class ViewFrame {
 public:
  /// From the rays of two pixels; nothing if these are closer than kLeastPixels.
  /// @param second  if rays diverge, its origin is the eye
  /// @param view    unit, viewing direction
  [[nodiscard]] static std::optional<ViewFrame> fromRays(const PixelRay &first, const PixelRay &second,
                                                         const Vec3 &view);
  static constexpr double kLeastPixels = 2.0;

  struct Pixel {
    double x = 0.0, y = 0.0;
    double depth = 0.0;  ///< m, along the viewing direction; of a perspective view: 0 or less is behind the eye
  };
  [[nodiscard]] Pixel project(const Vec3 &point) const;
  /// The ray through a pixel.
  [[nodiscard]] PixelRay ray(double x, double y) const;
  /// The point of a pixel at a depth, m.
  [[nodiscard]] Vec3 at(double x, double y, double depth) const;
  /// Corners of a rectangle at a depth, in turn.
  [[nodiscard]] std::array<Vec3, 4> corners(const PixelRect &rect, double depth) const;
  [[nodiscard]] const Vec3 &view() const { return view_; }
  [[nodiscard]] bool isPerspective() const { return isPerspective_; }

 private:
  [[nodiscard]] Vec3 onPlane(double x, double y) const { return (x - x_) * right_ + (y - y_) * down_; }

  bool isPerspective_ = false;
  double x_ = 0.0, y_ = 0.0;                         // px, of the first pixel
  Vec3 origin_ = Vec3::Zero();                       // the eye, or a point of the plane of depth 0
  Vec3 first_ = Vec3::Zero();                        // of the first pixel in the image plane at depth 1, or 0
  Vec3 right_ = Vec3::Zero(), down_ = Vec3::Zero();  // per pixel, in that plane
  Vec3 view_ = Vec3::UnitZ();
};

}  // namespace pointbased
