// SPDX-License-Identifier: Apache-2.0
// The accepted calls: the same for every back end.
#include "c3de/render_gl/gl_renderer.h"
#include "gl_fixture.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

/// One bit per call: whether it was accepted.
std::vector<bool> callEverything(Renderer &r) {
  std::vector<bool> accepted;
  const auto note = [&](bool yes) { accepted.push_back(yes); };
  const Shape quad = square(10, 0);
  const std::vector<Vec3f> four = quad.positions, three(four.begin(), four.begin() + 3), none;
  const std::vector<Triangle> outside{{0, 1, 4}};
  const std::vector<Colour> colours4(4, Colour{1, 0, 0, 1}), colours3(3, Colour{1, 0, 0, 1});
  const std::vector<float> radii4(4, 1.0f), radii3(3, 1.0f);

  const Handle mesh = r.createMesh(four, quad.triangles, {});
  const Handle spheres = r.createSpheres(four, 2.0f, {});
  const Handle lines = r.createLines(four, 2.0f, {});
  const Handle label = r.createLabel({0, 0, 0}, "text", {});
  for (const Handle h : {mesh, spheres, lines, label}) note(!h.isNull());
  note(!r.createMesh(four, outside, {}).isNull());
  note(!r.createMesh(none, {}, {}).isNull());
  note(!r.createSpheres(four, 0.0f, {}).isNull());
  note(!r.createSpheres(four, std::nanf(""), {}).isNull());
  note(!r.createSpheres(none, 1.0f, {}).isNull());
  note(!r.createLines(three, 1.0f, {}).isNull());
  note(!r.createLines(four, -1.0f, {}).isNull());

  for (const Handle h : {mesh, spheres, lines, label, Handle{}}) {
    note(r.setPositions(h, four));
    note(r.setPositions(h, three));
    note(r.setPositions(h, four));
    note(r.setNormals(h, four));
    note(r.setNormals(h, three));
    note(r.setNormals(h, none));
    note(r.setColours(h, colours4));
    note(r.setColours(h, colours3));
    note(r.setColours(h, {}));
    note(r.setRadii(h, radii4));
    note(r.setRadii(h, radii3));
    note(r.setLabel(h, {1, 2, 3}, "other"));
    note(r.setMaterial(h, {{1, 0, 0, 0.5f}, true}));
    note(r.setTransform(h, kIdentity4));
    note(r.setVisible(h, true));
  }
  note(r.drawToImage(frontCamera(), 32, 32).has_value());
  note(r.drawToImage(frontCamera(), -1, 32).has_value());
  note(r.drawToImage(frontCamera(), 1 << 28, 32).has_value());
  for (const Handle h : {mesh, spheres, lines, label}) {
    note(r.destroy(h));
    note(r.destroy(h));
    note(r.setVisible(h, true));
    note(r.setPositions(h, four));
  }
  // The slot is reused, the old handle stays stale.
  const Handle next = r.createMesh(four, quad.triangles, {});
  note(next == mesh);
  note(r.setVisible(mesh, true));
  note(r.setVisible(next, true));
  note(r.drawToImage(frontCamera(), 32, 32).has_value());
  return accepted;
}

}  // namespace

TEST_CASE("The null and the OpenGL renderer accept and refuse the same calls") {
  C3DE_GL_OR_SKIP(gl);
  const auto null = createNullRenderer();
  const auto byNull = callEverything(*null), byGl = callEverything(*gl.renderer);
  CHECK(byNull == byGl);
  // Both results occur.
  CHECK(std::count(byGl.begin(), byGl.end(), true) > 40);
  CHECK(std::count(byGl.begin(), byGl.end(), false) > 40);
}

TEST_CASE("A stale handle is refused by every call") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  const Handle spheres = r.createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 5.0f, {});
  drawn(r, frontCamera());
  REQUIRE(r.destroy(spheres));
  CHECK_FALSE(r.destroy(spheres));
  CHECK_FALSE(r.setPositions(spheres, std::vector<Vec3f>{{1, 1, 1}}));
  CHECK_FALSE(r.setMaterial(spheres, {}));
  CHECK_FALSE(r.setTransform(spheres, kIdentity4));
  CHECK_FALSE(r.setVisible(spheres, false));
}

TEST_CASE("The description names the version and the device") {
  C3DE_GL_OR_SKIP(gl);
  CHECK_THAT(gl.renderer->description(), Contains("OpenGL 4."));
}

TEST_CASE("Several renderers live one after another and side by side") {
  C3DE_GL_OR_SKIP(gl);
  auto second = createGlRenderer();
  REQUIRE(second.has_value());
  (*second)->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 20.0f, {{1, 0, 0, 1}});
  setBlackBackground(**second);
  setBlackBackground(*gl.renderer);
  CHECK(pixel(drawn(**second, frontCamera()), 80, 60)[0] > 100);
  CHECK(pixel(drawn(*gl.renderer, frontCamera()), 80, 60) == Rgb{0, 0, 0});
}

TEST_CASE("An old OpenGL version is refused by name", "[.][old-version]") {
  auto context = OffscreenContext::create();
  if (!context) C3DE_SKIP(context.error().message);
  const auto version = checkGlVersion();
  if (version) C3DE_SKIP("the driver cannot be told to offer an old version");
  CHECK(version.error().code == ErrorCode::graphics);
  CHECK_THAT(version.error().message, Contains("OpenGL 4.3 core is needed, found 3.1 ("));
  CHECK(!createGlRenderer().has_value());
}
