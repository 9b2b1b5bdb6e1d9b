// SPDX-License-Identifier: Apache-2.0
// Transparent objects are drawn from far to near, independent of their order of creation.
#include "gl_fixture.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kX = 80, kY = 60;

Rgb over(const Rgb &front, double opacity, const Rgb &back) {
  Rgb mixed{};
  for (std::size_t k = 0; k < 3; ++k)
    mixed[k] = static_cast<int>(std::lround(opacity * front[k] + (1.0 - opacity) * back[k]));
  return mixed;
}

/// The colour of an opaque object, alone, in the middle of the picture.
template <class Make>
Rgb aloneAndOpaque(Renderer &renderer, Make make) {
  const Handle h = make(1.0f);
  const Rgb colour = pixel(drawn(renderer, frontCamera()), kX, kY);
  renderer.destroy(h);
  return colour;
}

}  // namespace

TEST_CASE("Two transparent squares mix by the over-operator whatever the order of their creation") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  r.setBackground({{0.3f, 0.3f, 0.3f, 1}, {0.3f, 0.3f, 0.3f, 1}});
  const Shape near = square(15, 20), far = square(20, -20);
  const auto red = [&](float a) { return r.createMesh(near.positions, near.triangles, {{0.8f, 0.1f, 0.1f, a}, true}); };
  const auto blue = [&](float a) { return r.createMesh(far.positions, far.triangles, {{0.1f, 0.2f, 0.8f, a}, true}); };
  const Rgb redAlone = aloneAndOpaque(r, red), blueAlone = aloneAndOpaque(r, blue);
  const Rgb background{77, 77, 77};
  const Rgb expected = over(redAlone, 0.4, over(blueAlone, 0.7, background));

  const bool nearFirst = GENERATE(true, false);
  if (nearFirst) red(0.4f);
  blue(0.7f);
  if (!nearFirst) red(0.4f);
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), expected) <= 2);

  // From behind the order is reversed; the light moves with the viewer, so the single colours are the same.
  Camera behind = frontCamera();
  behind.yaw = 3.14159265358979;
  const Rgb turned = over(blueAlone, 0.7, over(redAlone, 0.4, background));
  CHECK(difference(turned, expected) > 20);
  CHECK(difference(pixel(drawn(r, behind), kX, kY), turned) <= 2);
}

// Where a scan ends, skin and organs share a face: stripes of both.
TEST_CASE("A transparent surface that crosses an opaque one within its cover is not seen, one before it is") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  const Shape wall = square(15, 0);
  Material material{{0.2f, 0.7f, 0.3f, 1.0f}};
  material.cover = 2.0f;
  const Handle organ = r.createMesh(wall.positions, wall.triangles, material);
  Camera camera = frontCamera();
  camera.yaw = 0.6;
  const Image alone = drawn(r, camera);
  // A roof that rises by 1 mm in front of the wall and falls by 1 mm behind it.
  const Shape roof{{{-15, -15, -1}, {15, -15, 1}, {15, 15, -1}, {-15, 15, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto seen = [&](const Image &image) {
    int different = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) different += difference(pixel(image, x, y), pixel(alone, x, y)) > 2;
    return different;
  };
  const auto film = [&](float z) {
    Shape shape = roof;
    for (Vec3f &x : shape.positions) x[2] += z;
    const Handle skin = r.createMesh(shape.positions, shape.triangles, {{0.8f, 0.6f, 0.5f, 0.4f}});
    const int different = seen(drawn(r, camera));
    r.destroy(skin);
    return different;
  };
  // At its rim the film extends beyond the wall by some pixels.
  CHECK(film(0.0f) < 40);
  const int before = film(4.0f);
  CHECK(before > 500);
  material.cover = 0.0f;
  REQUIRE(r.setMaterial(organ, material));
  const int striped = film(0.0f);
  CHECK(striped > before / 4);
  CHECK(striped < 3 * before / 4);
}

TEST_CASE("Triangles of different proxies interleave by depth") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  // Red at z = 10 and -10 in one proxy, blue at z = 0 in another: red over blue over red.
  Shape pair = square(15, 10);
  const Shape second = square(15, -10);
  pair.positions.insert(pair.positions.end(), second.positions.begin(), second.positions.end());
  for (const Triangle &t : second.triangles) pair.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  const Shape single = square(15, 0);
  const auto red = [&](float a) { return r.createMesh(pair.positions, pair.triangles, {{0.8f, 0.1f, 0.1f, a}}); };
  const auto blue = [&](float a) { return r.createMesh(single.positions, single.triangles, {{0.1f, 0.1f, 0.9f, a}}); };
  const Rgb redAlone = aloneAndOpaque(r, red), blueAlone = aloneAndOpaque(r, blue);
  red(0.5f);
  blue(0.5f);
  const Rgb expected = over(redAlone, 0.5, over(blueAlone, 0.5, over(redAlone, 0.5, {0, 0, 0})));
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), expected) <= 2);
}

TEST_CASE("An opaque sphere behind a transparent mesh shows through, one in front covers it") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  const Shape window = square(25, 0);
  const auto mesh = [&](float a) { return r.createMesh(window.positions, window.triangles, {{0.8f, 0.6f, 0.5f, a}}); };
  const float z = GENERATE(-30.0f, 30.0f);
  const std::vector<Vec3f> centre{{0, 0, z}};
  const auto sphere = [&](float a) { return r.createSpheres(centre, 12.0f, {{0.1f, 0.8f, 0.2f, a}}); };
  const Rgb meshAlone = aloneAndOpaque(r, mesh), sphereAlone = aloneAndOpaque(r, sphere);
  mesh(0.35f);
  sphere(1.0f);
  const Rgb expected = z < 0 ? over(meshAlone, 0.35, sphereAlone) : sphereAlone;
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), expected) <= 2);
}

TEST_CASE("Transparent spheres and lines take part in the same order") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  const Shape window = square(25, 0);
  const auto mesh = [&](float a) { return r.createMesh(window.positions, window.triangles, {{0.8f, 0.6f, 0.2f, a}}); };
  const std::vector<Vec3f> centre{{0, 0, -30}};
  const auto sphere = [&](float a) { return r.createSpheres(centre, 12.0f, {{0.1f, 0.8f, 0.2f, a}}); };
  const auto line = [&](float a) {
    return r.createLines(std::vector<Vec3f>{{-30, 0, 40}, {30, 0, 40}}, 8.0f, {{0.2f, 0.2f, 1.0f, a}});
  };
  const Rgb meshAlone = aloneAndOpaque(r, mesh), sphereAlone = aloneAndOpaque(r, sphere);
  const Rgb lineAlone = aloneAndOpaque(r, line);
  line(0.5f);
  mesh(0.5f);
  sphere(0.5f);
  const Rgb expected = over(lineAlone, 0.5, over(meshAlone, 0.5, over(sphereAlone, 0.5, {0, 0, 0})));
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), expected) <= 2);
}

TEST_CASE("Opacity per point times the material's opacity is what blends") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  const Shape window = square(25, 0);
  const Handle h = r.createMesh(window.positions, window.triangles, {{1, 1, 1, 1}});
  REQUIRE(r.setColours(h, std::vector<Colour>(4, Colour{0.7f, 0.5f, 0.3f, 1})));
  const Rgb full = pixel(drawn(r, frontCamera()), kX, kY);
  REQUIRE(r.setColours(h, std::vector<Colour>(4, Colour{0.7f, 0.5f, 0.3f, 0.5f})));
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), over(full, 0.5, {0, 0, 0})) <= 2);
  REQUIRE(r.setMaterial(h, {{1, 1, 1, 0.5f}}));
  CHECK(difference(pixel(drawn(r, frontCamera()), kX, kY), over(full, 0.25, {0, 0, 0})) <= 2);
}

TEST_CASE("Both sides of a transparent two-sided ball are sorted") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  setBlackBackground(r);
  const Shape ball = blob(30, 40, 30, 0.1f);
  const Handle h = r.createMesh(ball.positions, ball.triangles, {{0.8f, 0.4f, 0.3f, 0.5f}, true});
  const Image image = drawn(r, frontCamera());
  CHECK(r.statistics().sortedPrimitives == ball.triangles.size());
  // The triangles in reverse give the same picture.
  r.destroy(h);
  std::vector<Triangle> reversed(ball.triangles.rbegin(), ball.triangles.rend());
  r.createMesh(ball.positions, reversed, {{0.8f, 0.4f, 0.3f, 0.5f}, true});
  const Image again = drawn(r, frontCamera());
  int worst = 0;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) worst = std::max(worst, std::abs(image.rgb[i] - again.rgb[i]));
  CHECK(worst <= 1);
}
