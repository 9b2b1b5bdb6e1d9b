// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/camera.h"

#include <numbers>

#include "support/catch.h"

using namespace c3de;
using render::Camera;

namespace {

Camera tiltedCamera() {
  Camera camera;
  camera.focus = {10.0, -20.0, 35.0};
  camera.distance = 240.0;
  camera.yaw = -0.8;
  camera.pitch = 0.5;
  return camera;
}

constexpr int kWidth = 640, kHeight = 480;

double distanceToRay(const render::Ray &ray, const Vec3 &p) { return norm(cross(p - ray.origin, ray.direction)); }

}  // namespace

TEST_CASE("The axes of the camera are orthonormal and right-handed") {
  const Camera camera = tiltedCamera();
  const Vec3 r = camera.right(), u = camera.up(), f = camera.forward();
  for (const Vec3 &v : {r, u, f}) CHECK_THAT(norm(v), WithinAbs(1.0, 1e-14));
  CHECK_THAT(dot(r, u), WithinAbs(0.0, 1e-14));
  CHECK_THAT(dot(r, f), WithinAbs(0.0, 1e-14));
  CHECK_THAT(norm(cross(r, u) + f), WithinAbs(0.0, 1e-14));
  CHECK(u[1] > 0.0);
}

TEST_CASE("The focus is in the middle of the view at the camera's distance") {
  const Camera camera = tiltedCamera();
  const Vec3 pixel = camera.project(camera.focus, kWidth, kHeight);
  CHECK_THAT(pixel[0], WithinAbs(0.5 * kWidth, 1e-9));
  CHECK_THAT(pixel[1], WithinAbs(0.5 * kHeight, 1e-9));
  CHECK_THAT(pixel[2], WithinRel(camera.distance, 1e-12));
}

TEST_CASE("The ray through the pixel of a point passes through the point") {
  const Camera camera = tiltedCamera();
  for (const Vec3 &point : {Vec3{0, 0, 0}, Vec3{40, 10, -20}, Vec3{-35, -60, 80}}) {
    const Vec3 pixel = camera.project(point, kWidth, kHeight);
    const render::Ray ray = camera.pickRay(pixel[0], pixel[1], kWidth, kHeight);
    CHECK_THAT(norm(ray.direction), WithinAbs(1.0, 1e-14));
    CHECK_THAT(distanceToRay(ray, point), WithinAbs(0.0, 1e-9));
    CHECK(dot(point - ray.origin, ray.direction) > 0.0);
  }
}

TEST_CASE("A pixel further down and right means a ray further down and right") {
  const Camera camera = tiltedCamera();
  const auto middle = camera.pickRay(0.5 * kWidth, 0.5 * kHeight, kWidth, kHeight);
  const auto corner = camera.pickRay(kWidth, kHeight, kWidth, kHeight);
  CHECK(dot(corner.direction - middle.direction, camera.right()) > 0.0);
  CHECK(dot(corner.direction - middle.direction, camera.up()) < 0.0);
}

TEST_CASE("View and projection matrices agree with project()") {
  const Camera camera = tiltedCamera();
  const Vec3 point{30.0, 5.0, -10.0};
  const Vec3 view = transformPoint(camera.viewMatrix(), point);
  const Mat4 p = camera.projectionMatrix(static_cast<double>(kWidth) / kHeight);
  const Vec3 clip = transformPoint(p, view);
  const double w = p[11] * view[2];
  const Vec3 pixel = camera.project(point, kWidth, kHeight);
  CHECK_THAT(0.5 * kWidth * (1.0 + clip[0] / w), WithinAbs(pixel[0], 1e-9));
  CHECK_THAT(0.5 * kHeight * (1.0 - clip[1] / w), WithinAbs(pixel[1], 1e-9));
  CHECK_THAT(w, WithinRel(pixel[2], 1e-12));
}

TEST_CASE("The near and far planes are the ends of the depth range") {
  const Camera camera = tiltedCamera();
  const Mat4 p = camera.projectionMatrix(1.0);
  const auto depth = [&](double z) { return (p[10] * -z + p[14]) / z; };
  CHECK_THAT(depth(camera.nearPlane), WithinAbs(-1.0, 1e-12));
  CHECK_THAT(depth(camera.farPlane), WithinAbs(1.0, 1e-12));
}

TEST_CASE("A fitted box is inside the view and fills it") {
  Camera camera = tiltedCamera();
  const double aspect = GENERATE(1.0, 1.6, 0.5);
  const Vec3 low{-40.0, 10.0, 5.0}, high{60.0, 40.0, 90.0};
  const Vec3 direction = camera.forward();
  camera.fit(low, high, aspect);
  CHECK_THAT(norm(camera.forward() - direction), WithinAbs(0.0, 1e-14));

  const int height = 600, width = static_cast<int>(height * aspect);
  double largest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1) ? high[0] : low[0], (corner & 2) ? high[1] : low[1], (corner & 4) ? high[2] : low[2]};
    const Vec3 pixel = camera.project(p, width, height);
    CHECK(pixel[2] > camera.nearPlane);
    CHECK(pixel[2] < camera.farPlane);
    largest = std::max({largest, std::abs(2.0 * pixel[0] / width - 1.0), std::abs(2.0 * pixel[1] / height - 1.0)});
  }
  CHECK(largest <= 1.0);
  CHECK(largest > 0.9);
}

TEST_CASE("Fitting a tiny box brings the near plane along, and an empty one changes nothing") {
  Camera camera;
  camera.fit({0, 0, 0}, {0.01, 0.01, 0.01});
  CHECK(camera.distance < 0.1);
  CHECK(camera.nearPlane < camera.distance);
  const double distance = camera.distance;
  camera.fit({1, 1, 1}, {-1, -1, -1});
  camera.fit({0, 0, 0}, {std::nan(""), 1, 1});
  CHECK(camera.distance == distance);
  camera.fit({5, 5, 5}, {5, 5, 5});
  CHECK(camera.distance > 0.0);
  CHECK(std::isfinite(camera.distance));
}

TEST_CASE("Orbiting stops short of the poles and keeps the distance to the focus") {
  Camera camera = tiltedCamera();
  for (int i = 0; i < 20; ++i) camera.orbit(0.0, 500.0, kHeight);
  CHECK(camera.pitch < 0.5 * std::numbers::pi);
  CHECK(camera.pitch > 0.49 * std::numbers::pi);
  CHECK(camera.up()[1] > 0.0);
  for (int i = 0; i < 20; ++i) camera.orbit(0.0, -500.0, kHeight);
  CHECK(camera.pitch > -0.5 * std::numbers::pi);
  CHECK(camera.pitch < -0.49 * std::numbers::pi);
  CHECK_THAT(norm(camera.eye() - camera.focus), WithinRel(240.0, 1e-12));
}

TEST_CASE("Dragging to the right or down turns what is in front to the right or down") {
  Camera camera = tiltedCamera();
  const Vec3 front = camera.focus - 50.0 * camera.forward();
  camera.orbit(30.0, 20.0, kHeight);
  const Vec3 pixel = camera.project(front, kWidth, kHeight);
  CHECK(pixel[0] > 0.5 * kWidth);
  CHECK(pixel[1] > 0.5 * kHeight);
}

TEST_CASE("Panning moves the focus' old place by as many pixels as the drag") {
  Camera camera = tiltedCamera();
  const Vec3 point = camera.focus;
  camera.pan(37.0, -12.0, kHeight);
  const Vec3 pixel = camera.project(point, kWidth, kHeight);
  CHECK_THAT(pixel[0], WithinAbs(0.5 * kWidth + 37.0, 1e-9));
  CHECK_THAT(pixel[1], WithinAbs(0.5 * kHeight - 12.0, 1e-9));
}

TEST_CASE("Zooming in comes nearer, is undone by zooming out, and never passes the planes") {
  Camera camera = tiltedCamera();
  camera.zoom(3.0);
  CHECK(camera.distance < 240.0);
  camera.zoom(-3.0);
  CHECK_THAT(camera.distance, WithinRel(240.0, 1e-12));
  camera.zoom(1000.0);
  CHECK(camera.distance > camera.nearPlane);
  camera.zoom(-2000.0);
  CHECK(camera.distance < camera.farPlane);
}

TEST_CASE("Millimetres per pixel predict how far apart two points are drawn") {
  const Camera camera = tiltedCamera();
  const Vec3 a = camera.focus + Vec3{5.0, 3.0, 20.0}, b = a + 7.0 * camera.right();
  const double pixels = camera.project(b, kWidth, kHeight)[0] - camera.project(a, kWidth, kHeight)[0];
  CHECK_THAT(pixels * camera.millimetresPerPixel(a, kHeight), WithinRel(7.0, 1e-9));
}

TEST_CASE("With the patient's z upwards the camera looks from the front, and turns about z") {
  Camera camera;
  camera.upAxis = render::UpAxis::z;
  camera.yaw = camera.pitch = 0.0;
  camera.distance = 300.0;
  const auto near = [](const Vec3 &a, const Vec3 &b) { return norm(a - b) < 1e-12; };
  CHECK(near(camera.forward(), {0, 1, 0}));
  CHECK(near(camera.right(), {1, 0, 0}));
  CHECK(near(camera.up(), {0, 0, 1}));
  CHECK(near(camera.eye(), {0, -300, 0}));
  camera.yaw = 0.7;
  camera.pitch = -0.4;
  CHECK(camera.right()[2] == 0.0);
  CHECK(near(cross(camera.right(), camera.forward()), camera.up()));
  const Vec3 point{12, -7, 30};
  const Vec3 p = camera.project(point, 400, 300);
  const render::Ray ray = camera.pickRay(p[0], p[1], 400, 300);
  CHECK(norm(cross(point - ray.origin, ray.direction)) < 1e-9);
}
