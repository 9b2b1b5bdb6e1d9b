// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace c3de::render {
namespace {

// At ±90° the view direction is parallel to the world's up and the camera's right is undefined.
constexpr double kPitchLimit = 89.9 * std::numbers::pi / 180.0;
constexpr double kZoomPerStep = 0.9;
constexpr double kFitMargin = 1.05;
// A single point is framed as if it had this radius.
constexpr double kPointRadius_mm = 1.0;
// Planes relative to the fitted distance; at that distance a 24-bit depth buffer resolves 3e-5 of it.
constexpr double kNearPerDistance = 2e-3, kFarPerDistance = 20.0;

/// Converts from axes in which y is up.
Vec3 turned(UpAxis up, const Vec3 &v) { return up == UpAxis::y ? v : Vec3{v[0], -v[2], v[1]}; }

bool isFinite(const Vec3 &v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

}  // namespace

void Camera::orbit(double dx_px, double dy_px, int viewHeight_px) {
  if (viewHeight_px <= 0) return;
  const double radiansPerPixel = std::numbers::pi / viewHeight_px;
  yaw = std::remainder(yaw - dx_px * radiansPerPixel, 2.0 * std::numbers::pi);
  pitch = std::clamp(pitch + dy_px * radiansPerPixel, -kPitchLimit, kPitchLimit);
}

void Camera::pan(double dx_px, double dy_px, int viewHeight_px) {
  if (viewHeight_px <= 0) return;
  const double mmPerPixel = millimetresPerPixel(focus, viewHeight_px);
  focus = focus + (-dx_px * mmPerPixel) * right() + (dy_px * mmPerPixel) * up();
}

void Camera::zoom(double steps) {
  const double nearest = 2.0 * nearPlane, farthest = std::max(0.5 * farPlane, nearest);
  distance = std::clamp(distance * std::pow(kZoomPerStep, steps), nearest, farthest);
}

void Camera::fit(const Vec3 &min, const Vec3 &max, double aspect) {
  if (!isFinite(min) || !isFinite(max) || min[0] > max[0] || min[1] > max[1] || min[2] > max[2]) return;
  const double tanY = std::tan(0.5 * fieldOfView), tanX = tanY * std::clamp(aspect, 0.05, 20.0);
  const Vec3 f = forward(), r = right(), u = up();
  focus = 0.5 * (min + max);

  // Nearest eye on the line of sight from which all eight corners project inside the view.
  double needed = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at{(corner & 1) ? max[0] : min[0], (corner & 2) ? max[1] : min[1], (corner & 4) ? max[2] : min[2]};
    const Vec3 p = at - focus;
    const double half = std::max(std::abs(dot(p, r)) / tanX, std::abs(dot(p, u)) / tanY);
    needed = std::max(needed, kFitMargin * half - dot(p, f));
  }
  const double radius = 0.5 * norm(max - min);
  distance = std::max(needed, radius > 0.0 ? radius : kPointRadius_mm);
  nearPlane = kNearPerDistance * distance;
  farPlane = kFarPerDistance * distance;
}

Vec3 Camera::forward() const {
  const double p = std::clamp(pitch, -kPitchLimit, kPitchLimit);
  return turned(upAxis, {-std::cos(p) * std::sin(yaw), -std::sin(p), -std::cos(p) * std::cos(yaw)});
}

Vec3 Camera::eye() const { return focus - distance * forward(); }

Vec3 Camera::right() const { return turned(upAxis, {std::cos(yaw), 0.0, -std::sin(yaw)}); }

Vec3 Camera::up() const { return cross(right(), forward()); }

Mat4 Camera::viewMatrix() const {
  const Vec3 r = right(), u = up(), f = forward(), e = eye();
  return {r[0], u[0], -f[0], 0.0, r[1],       u[1],       -f[1],     0.0,
          r[2], u[2], -f[2], 0.0, -dot(r, e), -dot(u, e), dot(f, e), 1.0};
}

Mat4 Camera::projectionMatrix(double aspect) const {
  const double focal = 1.0 / std::tan(0.5 * fieldOfView), depth = nearPlane - farPlane;
  Mat4 m{};
  m[0] = focal / aspect;
  m[5] = focal;
  m[10] = (farPlane + nearPlane) / depth;
  m[11] = -1.0;
  m[14] = 2.0 * farPlane * nearPlane / depth;
  return m;
}

Ray Camera::pickRay(double x_px, double y_px, int width, int height) const {
  const double scale = 2.0 * std::tan(0.5 * fieldOfView) / height;  // image plane at distance 1, per pixel
  const double x = (x_px - 0.5 * width) * scale, y = (0.5 * height - y_px) * scale;
  const Vec3 d = forward() + x * right() + y * up();
  return {eye(), (1.0 / norm(d)) * d};
}

Vec3 Camera::project(const Vec3 &world, int width, int height) const {
  const Vec3 p = world - eye();
  const double depth = dot(p, forward());
  // A point in the plane of the eye has no pixel; a tiny depth keeps the numbers finite.
  const double safe = std::abs(depth) < 1e-12 ? 1e-12 : depth;
  const double scale = 0.5 * height / (std::tan(0.5 * fieldOfView) * safe);
  return {0.5 * width + dot(p, right()) * scale, 0.5 * height - dot(p, up()) * scale, depth};
}

double Camera::millimetresPerPixel(const Vec3 &world, int height) const {
  const double depth = std::abs(dot(world - eye(), forward()));
  return 2.0 * depth * std::tan(0.5 * fieldOfView) / std::max(height, 1);
}

}  // namespace c3de::render
