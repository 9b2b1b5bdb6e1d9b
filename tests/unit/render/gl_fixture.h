// SPDX-License-Identifier: Apache-2.0
// An offscreen renderer and simple shapes for the tests of the OpenGL back end.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "support/catch.h"

namespace c3de::render::test {

struct OffscreenGl {
  std::unique_ptr<OffscreenContext> context;
  std::unique_ptr<Renderer> renderer;  // destroyed first
};

/// Declares `gl`, an OffscreenGl, or skips the case on a machine without OpenGL.
#define C3DE_GL_OR_SKIP(gl)                                                                          \
  c3de::render::test::OffscreenGl gl;                                                                \
  {                                                                                                  \
    auto context = c3de::render::OffscreenContext::create();                                         \
    if (!context) C3DE_SKIP(context.error().message);                                                \
    gl.context = std::move(*context);                                                                \
    if (auto version = c3de::render::checkGlVersion(); !version) C3DE_SKIP(version.error().message); \
    auto renderer = c3de::render::createGlRenderer();                                                \
    if (!renderer) FAIL(renderer.error().message);                                                   \
    gl.renderer = std::move(*renderer);                                                              \
  }

using Rgb = std::array<int, 3>;

inline Rgb pixel(const Image &image, int x, int y) {
  const auto i = static_cast<std::size_t>(3 * (y * image.width + x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

inline int difference(const Rgb &a, const Rgb &b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Looking along -z at the origin from 200 mm.
inline Camera frontCamera() {
  Camera camera;
  camera.distance = 200.0;
  camera.yaw = camera.pitch = 0.0;
  return camera;
}

inline Image drawn(Renderer &renderer, const Camera &camera, int width = 160, int height = 120) {
  auto image = renderer.drawToImage(camera, width, height);
  if (!image) FAIL(image.error().message);
  return std::move(*image);
}

/// Black everywhere, so that drawn pixels are those that are not black.
inline void setBlackBackground(Renderer &renderer) { renderer.setBackground({{0, 0, 0, 1}, {0, 0, 0, 1}}); }

struct Shape {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

/// Square of the given half side in the plane z, facing +z.
inline Shape square(float half, float z) {
  return {{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Sphere of longitude and latitude, deformed into an organ-like shape by `bump` (0: a sphere).
inline Shape blob(unsigned rings, unsigned segments, float radius, float bump) {
  constexpr float kPi = 3.14159265f;
  Shape shape;
  for (unsigned i = 0; i <= rings; ++i)
    for (unsigned j = 0; j < segments; ++j) {
      const float a = kPi * float(i) / float(rings), b = 2.0f * kPi * float(j) / float(segments);
      const Vec3f n{std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)};
      const float lobes =
          std::sin(2.3f * n[0] + 0.4f) * std::cos(1.9f * n[1]) + 0.35f * std::sin(4.1f * n[2] + 2.0f * n[1]);
      const float r = radius * (1.0f + bump * lobes);
      shape.positions.push_back({1.3f * r * n[0], 0.85f * r * n[1], 0.9f * r * n[2]});
    }
  for (unsigned i = 0; i < rings; ++i)
    for (unsigned j = 0; j < segments; ++j) {
      const unsigned k = (j + 1) % segments, a = i * segments, b = (i + 1) * segments;
      if (i > 0) shape.triangles.push_back({a + j, a + k, b + j});
      if (i + 1 < rings) shape.triangles.push_back({a + k, b + k, b + j});
    }
  return shape;
}

}  // namespace c3de::render::test
