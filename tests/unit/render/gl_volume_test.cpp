// SPDX-License-Identifier: Apache-2.0
// Images in space: slices among meshes, and ray-cast volumes.
#include "gl_fixture.h"
#include "phantom.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kWidth = 320, kHeight = 240;

Handle added(Expected<Handle> handle) {
  if (!handle) FAIL(handle.error().message);
  return *handle;
}

void save(const Image &image, const char *name) {
  const auto written = writePng((testOutputFolder() / name).string(), image);
  if (!written) FAIL(written.error().message);
}

/// From the front of the patient, at the origin.
Camera patientCamera() {
  Camera camera;
  camera.upAxis = UpAxis::z;
  camera.distance = 200.0;
  camera.yaw = camera.pitch = 0.0;
  return camera;
}

ImageScene sceneOf(Handle image) {
  ImageScene scene;
  scene.look.image = image;
  scene.look.window = 1000.0;
  scene.look.level = 200.0;
  scene.volume.points = {{-200.0, {0, 0, 0, 0}},
                         {0.0, {0.8f, 0.5f, 0.3f, 0.02f}},
                         {300.0, {0.9f, 0.7f, 0.5f, 0.05f}},
                         {600.0, {1, 1, 1, 0.9f}}};
  return scene;
}

int mostDifferent(const Image &a, const Image &b) {
  int most = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) most = std::max(most, std::abs(int(a.rgb[i]) - int(b.rgb[i])));
  return most;
}

/// The fraction of the pixels of the letter A, seen by patientCamera(), that show it.
double legibility(const Image &image, double depth_mm) {
  int right = 0;
  const Camera camera = patientCamera();
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 5; ++column) {
      const Vec3 p = camera.project({3.0 * (column - 2), depth_mm, 3.0 * (3 - row)}, kWidth, kHeight);
      const bool isInk = letterRows('A')[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#';
      // Rays begin at different fractions of a step: neighbours differ.
      int sum = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          sum += pixel(image, static_cast<int>(p[0]) + dx, static_cast<int>(p[1]) + dy)[1];
      right += (sum > 9 * 150) == isInk;
    }
  return right / 35.0;
}

}  // namespace

TEST_CASE("A slice stands in space among meshes, the nearer one hides the other", "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(gl.renderer->images()->addImage(phantom.image())));
  scene.slices = {{{0, -23, 0}, {0, 1, 0}, {}}};
  gl.renderer->images()->setScene(scene);
  const Image alone = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  save(alone, "slice_in_space.png");
  CHECK(legibility(alone, -23.0) == 1.0);

  // A red ball cut in half by the slice.
  gl.renderer->createSpheres(std::vector<Vec3f>{{25, -23, 0}}, 8.0f, {{1, 0.1f, 0.1f, 1}});
  gl.renderer->createSpheres(std::vector<Vec3f>{{-25, -10, 0}}, 8.0f, {{0.1f, 1, 0.1f, 1}});
  const Image both = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  save(both, "slice_in_space_balls.png");
  const Camera camera = patientCamera();
  const Vec3 front = camera.project({25, -31, 0}, kWidth, kHeight),
             hidden = camera.project({-25, -23, 0}, kWidth, kHeight);
  const Rgb red = pixel(both, static_cast<int>(front[0]), static_cast<int>(front[1]));
  CHECK(red[0] > red[1] + 80);
  const Rgb grey = pixel(both, static_cast<int>(hidden[0]), static_cast<int>(hidden[1]));
  CHECK(grey[0] == grey[1]);
  CHECK(grey[0] > 40);
}

TEST_CASE("A plane cuts the box of an image in a polygon around their common middle", "[volume]") {
  const GridGeometry place{{10, 20, 30}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
  CHECK(sliceOutline(place, {4.5, 9.5, 14.5}, {0, 0, 1}).size() == 4);
  CHECK(sliceOutline(place, {4.5, 9.5, 14.5}, {3, 1.5, 1}).size() == 6);
  CHECK(sliceOutline(place, {4.5, 9.5, 31.0}, {0, 0, 1}).empty());
  double area = 0.0;
  const auto square = sliceOutline(place, {0, 0, 3}, {0, 0, 2});
  for (std::size_t i = 0; i < square.size(); ++i) {
    const Vec3 c = cross(square[i] - square[0], square[(i + 1) % square.size()] - square[0]);
    area += 0.5 * c[2];
  }
  CHECK_THAT(std::abs(area), WithinAbs(200.0, 1e-9));
}

TEST_CASE("Rays see the letter in front, in every technique", "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(gl.renderer->images()->addImage(phantom.image())));
  scene.showsVolume = true;
  gl.renderer->images()->setScene(scene);
  const Image shaded = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  save(shaded, "volume_shaded.png");
  CHECK(legibility(shaded, -26.0) > 0.9);
  scene.volume.isShaded = false;
  gl.renderer->images()->setScene(scene);
  CHECK(legibility(drawn(*gl.renderer, patientCamera(), kWidth, kHeight), -26.0) > 0.9);
  scene.volume.isMaximum = true;
  gl.renderer->images()->setScene(scene);
  const Image maximum = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  save(maximum, "volume_mip.png");
  // The S at the top is seen edge-on and the L from its side, both apart from the A.
  CHECK(legibility(maximum, -23.0) > 0.9);
  // Shifted by 500, no value is in the range of the ink.
  scene.volume.isMaximum = false;
  scene.volume.shift = 1000.0;
  gl.renderer->images()->setScene(scene);
  const Image empty = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  CHECK(pixel(empty, kWidth / 2, kHeight / 2)[1] < 10);
}

TEST_CASE("Rays end at opaque meshes", "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(gl.renderer->images()->addImage(phantom.image())));
  scene.showsVolume = true;
  scene.volume.isShaded = false;
  // White fog: brightness measures the path length through it.
  scene.volume.points = {{-900.0, {1, 1, 1, 0}}, {-899.0, {1, 1, 1, 0.01f}}, {1000.0, {1, 1, 1, 0.01f}}};
  gl.renderer->images()->setScene(scene);
  const Shape wall = square(100.0f, 0.0f);
  const Handle mesh = gl.renderer->createMesh(wall.positions, wall.triangles, {{0, 0, 0, 1}, true});
  const auto fogTo = [&](double y) {
    // The square is across the view at y.
    gl.renderer->setTransform(mesh, {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, y, 0, 1});
    return drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  };
  // Through the centre: the block begins at y = -30.5 and absorbs 1 % per millimetre. The black wall has a little
  // specular light.
  const int wallAlone = pixel(fogTo(-50.0), kWidth / 2, kHeight / 2)[1];
  CHECK(wallAlone < 30);
  for (const double y : {-20.0, 0.0, 20.0}) {
    const Image image = fogTo(y);
    const double passed = std::pow(0.99, y + 30.5);
    CAPTURE(y);
    // Half a step, and rounding at every step.
    CHECK_THAT(pixel(image, kWidth / 2, kHeight / 2)[1], WithinAbs(255.0 * (1.0 - passed) + wallAlone * passed, 4.0));
  }
  save(fogTo(0.0), "volume_wall.png");
}

TEST_CASE("Rays see displaced tissue where it is, and zeros change no bit", "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(images.addImage(phantom.image())));
  scene.showsVolume = true;
  scene.volume.isMaximum = GENERATE(false, true);
  images.setScene(scene);
  const Image still = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  const GridGeometry grid{{13, 13, 13}, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, -60, -60, -60, 1}};
  std::vector<float> u(3 * 13 * 13 * 13, 0.0f);
  scene.look.displacement = added(images.addDisplacement(grid, u));
  images.setScene(scene);
  CHECK(mostDifferent(drawn(*gl.renderer, patientCamera(), kWidth, kHeight), still) == 0);

  // 20 mm to the left: as if the image had been moved, also beyond its old box.
  for (std::size_t i = 0; i < u.size(); i += 3) u[i] = 20.0f;
  REQUIRE(images.setDisplacement(scene.look.displacement, u));
  const Image warped = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  save(warped, "volume_displaced.png");
  Mat4 moved = phantom.worldFromIndex;
  moved[12] += 20.0;
  ImageVoxels voxels = phantom.image();
  voxels.place.worldFromIndex = moved;
  scene.look.image = added(images.addImage(voxels));
  scene.look.displacement = {};
  images.setScene(scene);
  const Image expected = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  int wrong = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) wrong += difference(pixel(warped, x, y), pixel(expected, x, y)) > 24;
  // Gradients and weights differ in their last bits; edges of voxels may be rounded to either side.
  CHECK(wrong < kWidth * kHeight / 100);
  CHECK(mostDifferent(warped, still) > 100);
}

TEST_CASE("A moving view is coarse, at rest it is refined to what a picture shows, and then nothing is left to do",
          "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(gl.renderer->images()->addImage(phantom.image())));
  scene.showsVolume = true;
  gl.renderer->images()->setScene(scene);
  Camera camera = patientCamera();
  const Viewport viewport{0, 0, 64, 48};
  const auto framesToRest = [&] {
    int frames = 0;
    do {
      gl.renderer->draw(camera, viewport);
      ++frames;
    } while (gl.renderer->images()->wantsRefinement() && frames < 1000);
    return frames;
  };
  CHECK(framesToRest() > 2);
  const auto before = gl.renderer->statistics();
  CHECK(framesToRest() == 1);
  CHECK(gl.renderer->statistics().programsLinked == before.programsLinked);
  camera.orbit(10, 0, 100);
  CHECK(framesToRest() > 2);
  gl.renderer->setVisible(gl.renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 3.0f, {}), false);
  CHECK(framesToRest() > 2);
  scene.look.level += 1.0;
  gl.renderer->images()->setScene(scene);
  CHECK(framesToRest() > 2);
  gl.renderer->images()->setScene(scene);
  CHECK(framesToRest() == 1);
  scene.showsVolume = false;
  gl.renderer->images()->setScene(scene);
  CHECK(framesToRest() == 1);
}

TEST_CASE("Rays pass through what a body has left", "[volume]") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom = plainPhantom();
  ImageScene scene = sceneOf(added(images.addImage(phantom.image())));
  scene.showsVolume = true;
  scene.volume.isMaximum = GENERATE(false, true);
  images.setScene(scene);
  const Image still = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  const GridGeometry grid{{13, 13, 13}, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, -60, -60, -60, 1}};
  const std::vector<float> u(3 * 13 * 13 * 13, 0.0f);
  std::vector<float> gaps(13 * 13 * 13, 0.0f);
  const GridGeometry place = phantom.place();
  const std::vector<std::uint8_t> bodies(place.size[0] * place.size[1] * place.size[2], 255);
  scene.look.bodies = added(images.addImage({place, VoxelType::uint8, bodies.data()}));
  scene.look.leastGap = 2.0;
  scene.look.displacement = added(images.addDisplacement(grid, u, gaps));
  images.setScene(scene);
  CHECK(mostDifferent(drawn(*gl.renderer, patientCamera(), kWidth, kHeight), still) == 0);
  std::fill(gaps.begin(), gaps.end(), 3.0f);
  REQUIRE(images.setDisplacement(scene.look.displacement, u, gaps));
  images.setScene(scene);
  const Image empty = drawn(*gl.renderer, patientCamera(), kWidth, kHeight);
  for (int y = 0; y < kHeight; y += 5)
    for (int x = 0; x < kWidth; x += 5) REQUIRE(pixel(empty, x, y) == Rgb{0, 0, 0});
  CHECK(mostDifferent(still, empty) > 100);
}
