// SPDX-License-Identifier: Apache-2.0
#include "tools/view_frame.h"

#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

constexpr double kParallel = 1e-9;  // sine: rays with a smaller angle between them are parallel

}  // namespace

PixelRect PixelRect::between(const PixelRay &a, const PixelRay &b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

// The two rays define the image plane up to a rotation, and the pixels between them define that rotation.
std::optional<ViewFrame> ViewFrame::fromRays(const PixelRay &first, const PixelRay &second, const Vec3 &view) {
  const double dx = second.x - first.x, dy = second.y - first.y, pixels = std::hypot(dx, dy);
  if (!(pixels >= kLeastPixels)) return std::nullopt;
  ViewFrame out;
  out.view_ = view.normalized();
  out.x_ = first.x;
  out.y_ = first.y;
  out.isPerspective_ = first.direction.cross(second.direction).norm() > kParallel;
  Vec3 span;
  if (out.isPerspective_) {
    const auto inPlane = [&](const PixelRay &ray) {
      return Vec3(ray.direction / ray.direction.dot(out.view_) - out.view_);
    };
    out.origin_ = second.origin;
    out.first_ = inPlane(first);
    span = inPlane(second) - out.first_;
  } else {
    out.origin_ = first.origin;
    span = second.origin - first.origin;
    span -= span.dot(out.view_) * out.view_;
  }
  const double length = span.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  // right × down = view.
  const Vec3 along = span / length, across = out.view_.cross(along);
  const double c = dx / pixels, s = dy / pixels, scale = length / pixels;
  out.right_ = scale * (c * along - s * across);
  out.down_ = scale * (s * along + c * across);
  return out;
}

ViewFrame::Pixel ViewFrame::project(const Vec3 &point) const {
  const Vec3 from = point - origin_;
  const double depth = from.dot(view_);
  Vec3 plane = from - depth * view_;
  if (isPerspective_) {
    if (!(depth > 0.0)) return {0.0, 0.0, depth};
    plane = plane / depth - first_;
  }
  const double square = right_.squaredNorm();
  return {x_ + plane.dot(right_) / square, y_ + plane.dot(down_) / square, depth};
}

Vec3 ViewFrame::at(double x, double y, double depth) const {
  if (!isPerspective_) return origin_ + onPlane(x, y) + depth * view_;
  return origin_ + depth * (view_ + first_ + onPlane(x, y));
}

PixelRay ViewFrame::ray(double x, double y) const {
  if (!isPerspective_) return {x, y, origin_ + onPlane(x, y), view_};
  return {x, y, origin_, (view_ + first_ + onPlane(x, y)).normalized()};
}

std::array<Vec3, 4> ViewFrame::corners(const PixelRect &rect, double depth) const {
  return {at(rect.left, rect.top, depth), at(rect.right, rect.top, depth), at(rect.right, rect.bottom, depth),
          at(rect.left, rect.bottom, depth)};
}

}  // namespace pointbased
