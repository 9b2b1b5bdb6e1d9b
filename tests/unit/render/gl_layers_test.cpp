// SPDX-License-Identifier: Apache-2.0
// Blended surfaces inside a volume, and cuts through both.
#include <cmath>

#include "c3de/render/image_renderer.h"
#include "gl_fixture.h"
#include "gl_target.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr double kPerMillimetre = 0.02;  // opacity of the fog
constexpr double kHalf = 30.0;           // of the block of fog, mm

Handle added(Expected<Handle> handle) {
  if (!handle) FAIL(handle.error().message);
  return *handle;
}

void save(const Image &image, const char *name) {
  const auto written = writePng((testOutputFolder() / name).string(), image);
  if (!written) FAIL(written.error().message);
}

/// Along +y, the origin in the middle.
Camera patientCamera() {
  Camera camera;
  camera.upAxis = UpAxis::z;
  camera.distance = 200.0;
  camera.yaw = camera.pitch = 0.0;
  return camera;
}

/// A uniform block of 60 mm around the origin, seen as white fog.
ImageScene fogScene(ImageRenderer &images) {
  static const std::vector<std::int16_t> voxels(20 * 20 * 20, 100);
  const GridGeometry place{{20, 20, 20}, {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, -28.5, -28.5, -28.5, 1}};
  ImageScene scene;
  scene.look.image = added(images.addImage({place, VoxelType::int16, voxels.data(), 1.0, 0.0}));
  scene.look.window = 200.0;
  scene.look.level = 150.0;
  scene.showsVolume = true;
  scene.volume.isShaded = false;
  const auto a = static_cast<float>(kPerMillimetre);
  scene.volume.points = {{0.0, {1, 1, 1, a}}, {200.0, {1, 1, 1, a}}};
  return scene;
}

/// A square across the view at y, transparent or opaque.
Handle addPane(Renderer &renderer, double y, const Colour &colour) {
  const Shape shape = square(100.0f, 0.0f);
  const Handle mesh = renderer.createMesh(shape.positions, shape.triangles, {colour, true});
  renderer.setTransform(mesh, {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, y, 0, 1});
  return mesh;
}

Rgb centreOf(const Image &image) { return pixel(image, kWidth / 2, kHeight / 2); }

int mostDifferent(const Image &a, const Image &b) {
  int most = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) most = std::max(most, std::abs(int(a.rgb[i]) - int(b.rgb[i])));
  return most;
}

/// Transmittance of a number of millimetres of fog.
double through(double mm) { return std::pow(1.0 - kPerMillimetre, std::max(mm, 0.0)); }

}  // namespace

TEST_CASE("A transparent surface lies in front of, inside of or behind a volume", "[layers]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Colour red{1.0f, 0.0f, 0.0f, 0.5f};
  const Handle pane = addPane(*gl.renderer, -60.0, red);
  const Rgb alone = centreOf(drawn(*gl.renderer, patientCamera(), kWidth, kHeight));
  ImageRenderer &images = *gl.renderer->images();
  images.setScene(fogScene(images));
  for (const double y : {-60.0, -15.0, 0.0, 15.0, 60.0}) {
    gl.renderer->setTransform(pane, {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, y, 0, 1});
    const Image image = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
    if (y == 0.0) save(image, "layer_inside.png");
    const double inFront = std::clamp(y, -kHalf, kHalf) + kHalf, behind = 2.0 * kHalf - inFront;
    const Rgb found = centreOf(image);
    for (std::size_t c = 0; c < 3; ++c) {
      // `alone` is the pane over black: its colour times its opacity.
      const double expected =
          255.0 * (1.0 - through(inFront)) + through(inFront) * (alone[c] + 0.5 * 255.0 * (1.0 - through(behind)));
      CAPTURE(y, c);
      // Steps begin anywhere within a millimetre and a half; 8 bits at three stages.
      CHECK_THAT(found[c], WithinAbs(expected, 5.0));
    }
  }
}

TEST_CASE("Two transparent surfaces stand each in its place in a volume, what is farther behind them", "[layers]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const bool isMaximum = GENERATE(false, true);
  ImageRenderer &images = *gl.renderer->images();
  ImageScene scene = fogScene(images);
  scene.volume.isMaximum = isMaximum;
  images.setScene(scene);
  const Rgb fog = centreOf(drawn(*gl.renderer, patientCamera(), kWidth, kHeight));
  const std::array<double, 3> places{10.0, -10.0, 20.0};
  std::vector<Handle> panes;
  for (const double y : places) panes.push_back(addPane(*gl.renderer, y, {0.0f, 0.0f, 0.0f, 0.5f}));
  const Image image = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  const Rgb found = centreOf(image);
  for (const Handle pane : panes) gl.renderer->setVisible(pane, false);
  for (const std::size_t shown : {1, 0, 2}) gl.renderer->setVisible(panes[shown], true);
  CHECK(mostDifferent(image, drawn(*gl.renderer, patientCamera(), kWidth, kHeight)) == 0);
  if (isMaximum) {
    // All of the light is in front of the first pane.
    CHECK_THAT(fog[1], WithinAbs(63.75, 2.0));
    CHECK(found[1] >= fog[1]);
    CHECK(found[1] < fog[1] + 40);
    return;
  }
  // Black panes with a little specular light halve the background.
  const double a = 1.0 - through(20.0), b = 1.0 - through(20.0), c = 1.0 - through(20.0);
  const double expected = 255.0 * (a + through(20.0) * 0.5 * (b + through(20.0) * 0.5 * c));
  CHECK(found[1] > expected - 5.0);
  CHECK(found[1] < expected + 25.0);
}

TEST_CASE("Surfaces that cannot be seen change nothing of a volume", "[layers]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  ImageScene scene = fogScene(images);
  scene.volume.isMaximum = GENERATE(false, true);
  images.setScene(scene);
  const Image before = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  addPane(*gl.renderer, 0.0, {1, 1, 1, 0.001f});
  // Parts are stored in 8 bits each.
  CHECK(mostDifferent(before, drawn(*gl.renderer, patientCamera(), kWidth, kHeight)) <= 3);
}

TEST_CASE("While it moves a volume has its transparent surface between its parts, and at rest as well", "[layers]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  addPane(*gl.renderer, 0.0, {1, 0, 0, 0.5f});
  ImageScene scene = fogScene(images);
  scene.movingDivisor = 4;
  images.setScene(scene);
  const Rgb wanted = centreOf(drawn(*gl.renderer, patientCamera(), kWidth, kHeight));
  const Target screen(300, 260);
  // Not at the corner: depths have to be those of the viewport.
  const Viewport viewport{60, 70, kWidth, kHeight};
  const auto centre = [&] { return screen.at(viewport.x + kWidth / 2, viewport.y + kHeight / 2); };
  gl.renderer->draw(patientCamera(), viewport);
  CHECK(images.wantsRefinement());
  const auto coarse = centre();
  int frames = 0;
  while (images.wantsRefinement() && ++frames < 200) gl.renderer->draw(patientCamera(), viewport);
  CHECK(frames < 200);
  const auto fine = centre();
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK_THAT(fine[c], WithinAbs(double(wanted[c]), 3.0));
    CHECK_THAT(coarse[c], WithinAbs(double(wanted[c]), 9.0));  // steps of 4.5 mm
  }
  CHECK(glGetError() == GL_NO_ERROR);
}

TEST_CASE("A cut leaves of a volume what lies before its plane", "[cuts]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  ImageScene scene = fogScene(images);
  const auto fog = [&](std::vector<CutPlane> cuts) {
    scene.cuts = std::move(cuts);
    images.setScene(scene);
    return static_cast<double>(centreOf(drawn(*gl.renderer, patientCamera(), kWidth, kHeight))[1]);
  };
  // The normal points to the removed side: the front 20 mm, the back 20 mm, both.
  CHECK_THAT(fog({{{5, -10, 3}, {0, -1, 0}}}), WithinAbs(255.0 * (1.0 - through(40.0)), 5.0));
  CHECK_THAT(fog({{{0, 10, 0}, {0, 2, 0}}}), WithinAbs(255.0 * (1.0 - through(40.0)), 5.0));
  CHECK_THAT(fog({{{0, -10, 0}, {0, -1, 0}}, {{0, 10, 0}, {0, 1, 0}}}), WithinAbs(255.0 * (1.0 - through(20.0)), 5.0));
  CHECK(fog({{{0, 0, 0}, {0, -1, 0}}, {{0, 0, 0}, {0, 1, 0}}}) < 2.0);
  CHECK_THAT(fog({{{-1, 0, 0}, {-1, 0, 0}}}), WithinAbs(255.0 * (1.0 - through(60.0)), 5.0));
  CHECK(fog({{{-1, 0, 0}, {1, 0, 0}}}) < 2.0);
}

TEST_CASE("A cut takes meshes along where that is asked for, and never the slice in its plane", "[cuts]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  ImageScene scene = fogScene(images);
  scene.showsVolume = false;
  scene.look.level = 100.0;  // grey
  const float opacity = GENERATE(1.0f, 0.5f);
  addPane(*gl.renderer, -20.0, {1.0f, 0.0f, 0.0f, opacity});
  gl.renderer->createLines(std::vector<Vec3f>{{-50, -40, 20}, {50, -40, 20}}, 5.0f, {{0, 1, 0, opacity}});
  gl.renderer->createSpheres(std::vector<Vec3f>{{0, -25, -20}}, 6.0f, {{0, 0, 1, opacity}});
  scene.slices = {{{0, 0, 0}, {0, 1, 0}, {}}, {{0, 0, -5}, {0, 0, 1}, {}}};
  const auto draw = [&](bool cutsProxies) {
    scene.cuts = {{{0, 0, 0}, {0, -1, 0}}};
    scene.cutsProxies = cutsProxies;
    images.setScene(scene);
    return drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  };
  const auto at = [](const Image &image, const Vec3 &world) {
    const Vec3 p = patientCamera().project(world, kWidth, kHeight);
    return pixel(image, static_cast<int>(p[0]), static_cast<int>(p[1]));
  };
  const Image whole = draw(false), cut = draw(true);
  if (opacity == 1.0f) save(cut, "cut_at_slice.png");
  CHECK(at(whole, {0, -20, 10})[0] > at(whole, {0, -20, 10})[1] + 60);
  CHECK(at(whole, {0, -40, 20})[1] > at(whole, {0, -40, 20})[0] + 20);
  CHECK(at(whole, {0, -31, -20})[2] > at(whole, {0, -31, -20})[1] + 40);
  for (const Vec3 &place : {Vec3{0, 0, 10}, Vec3{0, 0, 20}, Vec3{0, 0, -20}}) {
    const Rgb grey = at(cut, place);
    CAPTURE(place);
    CHECK(grey[0] == grey[1]);
    CHECK(grey[1] == grey[2]);
    CHECK_THAT(grey[0], WithinAbs(127.5, 2.0));
  }
  // Beyond the image nothing of the pane remains.
  CHECK(at(cut, {40, -20, 30})[0] < 10);
  CHECK(at(whole, {40, -20, 30})[0] > 60);
}

TEST_CASE("Cuts leave of a polygon what lies before them", "[cuts]") {
  const std::vector<Vec3> square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const auto area = [](const std::vector<Vec3> &p) {
    Vec3 sum{};
    for (std::size_t i = 1; i + 1 < p.size(); ++i) sum = sum + cross(p[i] - p[0], p[i + 1] - p[0]);
    return 0.5 * norm(sum);
  };
  CHECK_THAT(area(cutPolygon(square, {})), WithinAbs(16.0, 1e-12));
  // Points within a micrometre of a plane count as in it.
  CHECK_THAT(area(cutPolygon(square, std::vector<CutPlane>{{{1, 0, 0}, {3, 0, 0}}})), WithinAbs(4.0, 5e-3));
  CHECK_THAT(area(cutPolygon(square, std::vector<CutPlane>{{{1, 1, 5}, {1, 1, 0}}})), WithinAbs(2.0, 1e-2));
  CHECK(cutPolygon(square, std::vector<CutPlane>{{{-1, 0, 0}, {1, 0, 0}}}).empty());
  CHECK_THAT(area(cutPolygon(square, std::vector<CutPlane>{{{7, 7, 0}, {0, 0, 1}}})), WithinAbs(16.0, 1e-12));
  CHECK_THAT(area(cutPolygon(square, std::vector<CutPlane>{{{7, 7, 0}, {0, 0, -1}}})), WithinAbs(16.0, 1e-12));
}
