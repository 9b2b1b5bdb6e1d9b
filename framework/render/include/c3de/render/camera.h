// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/vec.h"

namespace c3de::render {

struct Ray {
  Vec3 origin{}, direction{};  ///< world, mm; unit direction
};

/// The world axis that points upwards on the screen: y for meshes, z for patients (LPS).
enum class UpAxis { y, z };

/// Orbit camera around a focal point. Angles in radians, lengths in mm. Value type; any thread.
struct Camera {
  Vec3 focus{};
  double distance = 500.0;
  double yaw = 0.6, pitch = 0.35;  ///< about the world's up; pitch within ±89.9°
  UpAxis upAxis = UpAxis::y;       ///< yaw 0 looks along -z (y up) or +y (z up, from the front of the patient)
  double fieldOfView = 0.6;        ///< vertical, rad
  double nearPlane = 1.0, farPlane = 10000.0;

  /// Mouse drags in pixels, y down: the scene follows the mouse. A drag over the height of the view is half a turn.
  void orbit(double dx_px, double dy_px, int viewHeight_px);
  void pan(double dx_px, double dy_px, int viewHeight_px);
  /// > 0: closer, by a tenth per step. The distance is limited to what the near and far planes can show.
  void zoom(double steps);
  /// Fits the box into the view; keeps the direction and sets the planes to the size of the box. An empty or non-finite
  /// box is ignored.
  /// @param aspect  width / height of the view; the default is safe for every view that is at least as wide as high
  void fit(const Vec3 &min, const Vec3 &max, double aspect = 1.0);

  [[nodiscard]] Vec3 eye() const;
  [[nodiscard]] Vec3 forward() const;
  [[nodiscard]] Vec3 right() const;
  [[nodiscard]] Vec3 up() const;
  [[nodiscard]] Mat4 viewMatrix() const;
  /// As in OpenGL: depth from -1 (near) to 1 (far).
  [[nodiscard]] Mat4 projectionMatrix(double aspect) const;
  /// Through the pixel (from the view's upper left corner; the centre of the first pixel is at 0.5).
  [[nodiscard]] Ray pickRay(double x_px, double y_px, int width, int height) const;
  /// Pixel of a world point and its depth along forward(), mm; z > 0 in front of the camera.
  [[nodiscard]] Vec3 project(const Vec3 &world, int width, int height) const;
  /// Millimetres per pixel at the depth of a world point.
  [[nodiscard]] double millimetresPerPixel(const Vec3 &world, int height) const;

  friend bool operator==(const Camera &, const Camera &) = default;
};

}  // namespace c3de::render
