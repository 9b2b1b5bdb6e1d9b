// SPDX-License-Identifier: Apache-2.0
// Pictures for visual inspection; the checks only require that the main objects are visible.
#include <filesystem>

#include "gl_fixture.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kWidth = 640, kHeight = 400;

void save(const Image &image, const char *name) {
  std::filesystem::create_directories(testOutputRoot());
  const auto written = writePng((std::filesystem::path(testOutputRoot()) / name).string(), image);
  if (!written) FAIL(written.error().message);
}

Camera organCamera() {
  Camera camera;
  camera.yaw = 0.4;
  camera.fit({-52, -36, -36}, {52, 40, 36}, static_cast<double>(kWidth) / kHeight);
  return camera;
}

/// Points on a grid well inside the blob.
std::vector<Vec3f> pointsInside(float radius) {
  std::vector<Vec3f> points;
  for (float x = -50; x <= 50; x += 8)
    for (float y = -30; y <= 30; y += 8)
      for (float z = -32; z <= 32; z += 8)
        if (std::hypot(x / 1.3f, y / 0.85f, z / 0.9f) < 0.72f * radius) points.push_back({x, y, z});
  return points;
}

}  // namespace

TEST_CASE("Picture of an opaque organ") {
  C3DE_GL_OR_SKIP(gl);
  const Shape organ = blob(120, 128, 38, 0.24f);
  gl.renderer->createMesh(organ.positions, organ.triangles, {{0.62f, 0.24f, 0.20f, 1}});
  gl.renderer->createLabel({0, 38, 0}, "Liver 1 480 cm³\nE = 4.5 kPa, ρ = 1060 kg/m³, 37 °C", {{1, 1, 1, 1}});
  const Image image = drawn(*gl.renderer, organCamera(), kWidth, kHeight);
  save(image, "organ_opaque.png");
  const Rgb middle = pixel(image, kWidth / 2, kHeight / 2);
  CHECK(middle[0] > middle[1] + 40);
}

TEST_CASE("Picture of a transparent organ with spheres inside") {
  C3DE_GL_OR_SKIP(gl);
  const Shape organ = blob(120, 128, 38, 0.24f);
  const bool twoSided = GENERATE(false, true);
  gl.renderer->createMesh(organ.positions, organ.triangles, {{0.80f, 0.45f, 0.40f, 0.30f}, twoSided});
  const std::vector<Vec3f> points = pointsInside(35);
  const Handle spheres = gl.renderer->createSpheres(points, 2.2f, {});
  std::vector<Colour> colours;
  for (const Vec3f &p : points) {
    const float t = 0.006f * (p[0] + 50);
    colours.push_back({0.25f + t, 0.65f, 0.95f - t, 1});
  }
  REQUIRE(gl.renderer->setColours(spheres, colours));
  const std::vector<Vec3f> axes{{-60, -38, 0}, {60, -38, 0}, {-60, -38, 0}, {-60, 38, 0}};
  gl.renderer->createLines(axes, 2.0f, {{0.9f, 0.9f, 0.5f, 1}});
  gl.renderer->createLabel({60, -38, 0}, "120 mm", {{0.95f, 0.95f, 0.6f, 1}});
  const Image image = drawn(*gl.renderer, organCamera(), kWidth, kHeight);
  save(image, twoSided ? "organ_transparent_two_sided.png" : "organ_transparent.png");
  CHECK(gl.renderer->statistics().sortedPrimitives > 10000);
}

TEST_CASE("Picture of an organ with a legend") {
  C3DE_GL_OR_SKIP(gl);
  const Shape organ = blob(60, 64, 34, 0.2f);
  gl.renderer->createMesh(organ.positions, organ.triangles, {});
  gl.renderer->createLegend({"Stress (von Mises)",
                             "kPa",
                             "largest 2.31 kPa\n2 bodies",
                             0.0,
                             2.5,
                             {{0.27f, 0, 0.33f, 1}, {0.13f, 0.57f, 0.55f, 1}, {0.99f, 0.91f, 0.14f, 1}}});
  const Image image = drawn(*gl.renderer, organCamera(), kWidth, kHeight);
  save(image, "legend.png");
  CHECK(image.rgb.size() == std::size_t{3} * kWidth * kHeight);
}

TEST_CASE("Picture of a mesh with colours per point, spheres and lines") {
  C3DE_GL_OR_SKIP(gl);
  const Shape organ = blob(60, 64, 30, 0.2f);
  const Handle mesh = gl.renderer->createMesh(organ.positions, organ.triangles, {});
  std::vector<Colour> colours;
  for (const Vec3f &p : organ.positions) {
    const float t = 0.5f + 0.5f * std::sin(0.12f * p[0] + 0.08f * p[1]);
    colours.push_back({t, 0.35f + 0.4f * t * (1 - t), 1 - t, 1});
  }
  REQUIRE(gl.renderer->setColours(mesh, colours));
  std::vector<Vec3f> edges;
  for (std::size_t i = 0; i < organ.triangles.size(); i += 2)
    for (const unsigned k : {0u, 1u}) edges.push_back(organ.positions[organ.triangles[i][k]]);
  gl.renderer->createLines(edges, 1.0f, {{0.05f, 0.05f, 0.08f, 0.35f}});
  gl.renderer->createSpheres(std::vector<Vec3f>{{-55, 0, 0}, {55, 0, 0}, {0, 38, 0}}, 7.0f, {{0.9f, 0.85f, 0.7f, 1}});
  gl.renderer->createLabel({55, 8, 0}, "3 mm² × 2 µm", {{0.6f, 0.9f, 1.0f, 1}});
  const Image image = drawn(*gl.renderer, organCamera(), kWidth, kHeight);
  save(image, "colours_lines_spheres.png");
  CHECK(image.rgb.size() == std::size_t{3} * kWidth * kHeight);
}
