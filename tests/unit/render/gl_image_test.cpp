// SPDX-License-Identifier: Apache-2.0
// The appearance of single shapes.
#include "c3de/render/image_renderer.h"
#include "gl_fixture.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

int countLit(const Image &image) {
  int lit = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) lit += difference(pixel(image, x, y), {0, 0, 0}) > 40;
  return lit;
}

constexpr double kPi = 3.14159265358979;

/// Radius in pixels of the silhouette of a sphere on the axis of the camera.
double silhouetteRadius_px(const Camera &camera, double radius, int height) {
  const double tangent = radius / std::sqrt(camera.distance * camera.distance - radius * radius);
  return 0.5 * height * tangent / std::tan(0.5 * camera.fieldOfView);
}

}  // namespace

TEST_CASE("The background runs from its lower to its upper colour") {
  C3DE_GL_OR_SKIP(gl);
  gl.renderer->setBackground({{0.2f, 0.4f, 0.8f, 1}, {0.8f, 0.2f, 0.0f, 1}});
  const Image image = drawn(*gl.renderer, frontCamera(), 64, 200);
  CHECK(difference(pixel(image, 10, 0), {51, 102, 204}) <= 2);
  CHECK(difference(pixel(image, 50, 199), {204, 51, 0}) <= 2);
  CHECK(difference(pixel(image, 32, 100), {128, 77, 102}) <= 2);
}

TEST_CASE("A red sphere is red and its silhouette is as large as the projection says") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const float radius = GENERATE(5.0f, 25.0f, 45.0f);
  gl.renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, radius, {{0.9f, 0.1f, 0.1f, 1}});
  const Camera camera = frontCamera();
  const Image image = drawn(*gl.renderer, camera, 320, 240);
  const Rgb middle = pixel(image, 160, 120);
  CHECK(middle[0] > 150);
  CHECK(middle[1] < 90);

  const double expected = silhouetteRadius_px(camera, radius, 240);
  CHECK_THAT(std::sqrt(countLit(image) / kPi), WithinAbs(expected, 0.6));
  // Along the row and the column through the middle the edge is at its expected position.
  const int edge = static_cast<int>(expected);
  for (const auto &[dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    CHECK(difference(pixel(image, 160 + dx * (edge - 2), 120 + dy * (edge - 2)), {0, 0, 0}) > 40);
    CHECK(pixel(image, 160 + dx * (edge + 3), 120 + dy * (edge + 3)) == Rgb{0, 0, 0});
  }
}

TEST_CASE("A sphere far from the axis covers the pixels of its cone of sight") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  Camera camera = frontCamera();
  camera.fieldOfView = 1.4;
  const Vec3 centre{120, 70, 0};
  const double radius = 30;
  gl.renderer->createSpheres(std::vector<Vec3f>{{120, 70, 0}}, 30.0f, {{0.2f, 0.9f, 0.2f, 1}});
  const int width = 320, height = 240;
  const Image image = drawn(*gl.renderer, camera, width, height);
  int wrong = 0, inside = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.pickRay(x + 0.5, y + 0.5, width, height);
      const double distance = norm(cross(centre - ray.origin, ray.direction));
      if (std::abs(distance - radius) < 1.5) continue;  // about one pixel at the edge
      const bool lit = difference(pixel(image, x, y), {0, 0, 0}) > 40;
      inside += distance < radius;
      wrong += lit != (distance < radius);
    }
  CHECK(inside > 500);
  CHECK(wrong == 0);
}

TEST_CASE("Radii per sphere and the scale of the transform change the size") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Camera camera = frontCamera();
  const Handle h = gl.renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 10.0f, {});
  const auto radius = [&] { return std::sqrt(countLit(drawn(*gl.renderer, camera, 320, 240)) / kPi); };
  CHECK_THAT(radius(), WithinAbs(silhouetteRadius_px(camera, 10, 240), 0.6));
  REQUIRE(gl.renderer->setRadii(h, std::vector<float>{20.0f}));
  CHECK_THAT(radius(), WithinAbs(silhouetteRadius_px(camera, 20, 240), 0.6));
  REQUIRE(gl.renderer->setTransform(h, Mat4{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}));
  CHECK_THAT(radius(), WithinAbs(silhouetteRadius_px(camera, 40, 240), 0.6));
  REQUIRE(gl.renderer->setRadii(h, {}));
  CHECK_THAT(radius(), WithinAbs(silhouetteRadius_px(camera, 20, 240), 0.6));
}

TEST_CASE("A sphere cut by a mesh shows exactly the cap in front of it") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  // The plane z = 12 cuts the sphere of radius 20 in a circle of radius 16.
  const Shape plane = square(60, 12);
  const bool meshFirst = GENERATE(true, false);
  const auto addPlane = [&] { gl.renderer->createMesh(plane.positions, plane.triangles, {{0.1f, 0.1f, 0.9f, 1}}); };
  if (meshFirst) addPlane();
  gl.renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 20.0f, {{0.9f, 0.1f, 0.1f, 1}});
  if (!meshFirst) addPlane();
  const Camera camera = frontCamera();
  const Image image = drawn(*gl.renderer, camera, 320, 240);
  int red = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) red += pixel(image, x, y)[0] > pixel(image, x, y)[2];
  const double expected = 0.5 * 240 * 16.0 / ((200.0 - 12.0) * std::tan(0.5 * camera.fieldOfView));
  CHECK_THAT(std::sqrt(red / kPi), WithinAbs(expected, 0.6));
}

TEST_CASE("A mesh seen from behind is drawn only when it is two-sided, also mirrored") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const float opacity = GENERATE(1.0f, 0.6f);
  const Shape quad = square(20, 0);
  const Handle h = gl.renderer->createMesh(quad.positions, quad.triangles, {{0.8f, 0.8f, 0.8f, opacity}, false});
  const auto middle = [&](const Camera &camera) { return pixel(drawn(*gl.renderer, camera), 80, 60); };
  const Camera front = frontCamera();
  Camera back = front;
  back.yaw = kPi;
  const Rgb facing = middle(front);
  CHECK(facing[0] > 60);
  CHECK(middle(back) == Rgb{0, 0, 0});
  // Mirrored in z, the outside faces the other direction.
  REQUIRE(gl.renderer->setTransform(h, Mat4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}));
  CHECK(middle(front) == Rgb{0, 0, 0});
  CHECK(difference(middle(back), facing) <= 2);
  REQUIRE(gl.renderer->setTransform(h, kIdentity4));
  REQUIRE(gl.renderer->setMaterial(h, {{0.8f, 0.8f, 0.8f, opacity}, true}));
  CHECK(difference(middle(front), facing) <= 2);
  CHECK(difference(middle(back), facing) <= 2);
}

TEST_CASE("Light falls from above and does not depend on where the scene is") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Shape ball = blob(40, 60, 30, 0);
  const Handle h = gl.renderer->createMesh(ball.positions, ball.triangles, {{0.6f, 0.6f, 0.6f, 1}});
  const Image near = drawn(*gl.renderer, frontCamera());
  CHECK(pixel(near, 80, 45)[0] > pixel(near, 80, 75)[0] + 20);
  CHECK(pixel(near, 80, 60)[0] > 120);

  // A hundred metres away the picture is the same: positions are sent to the card relative to the eye.
  REQUIRE(gl.renderer->setTransform(h, Mat4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1e5, -1e5, 1e5, 1}));
  Camera far = frontCamera();
  far.focus = {1e5, -1e5, 1e5};
  const Image moved = drawn(*gl.renderer, far);
  int worst = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) worst = std::max(worst, difference(pixel(near, x, y), pixel(moved, x, y)));
  CHECK(worst <= 3);
}

TEST_CASE("Normals follow the positions unless they are given") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Shape quad = square(20, 0);
  const Handle h = gl.renderer->createMesh(quad.positions, quad.triangles, {{0.5f, 0.5f, 0.5f, 1}, true});
  const auto brightness = [&] { return pixel(drawn(*gl.renderer, frontCamera()), 80, 62)[0]; };
  const int upright = brightness();
  // Lean the upper edge towards the viewer: the face points down, away from the light.
  std::vector<Vec3f> leaning = quad.positions;
  leaning[2][2] = leaning[3][2] = 60.0f;
  REQUIRE(gl.renderer->setPositions(h, leaning));
  const int dark = brightness();
  CHECK(dark < upright - 20);
  REQUIRE(gl.renderer->setNormals(h, std::vector<Vec3f>(4, Vec3f{0, 0, 1})));
  CHECK(std::abs(brightness() - upright) <= 6);
  REQUIRE(gl.renderer->setNormals(h, {}));
  CHECK(brightness() == dark);
}

TEST_CASE("Colours per point replace the material's and blend between the points") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Shape quad = square(30, 0);
  const Handle h = gl.renderer->createMesh(quad.positions, quad.triangles, {{0, 0, 1, 1}});
  const Colour red{0.8f, 0, 0, 1}, green{0, 0.8f, 0, 1};
  REQUIRE(gl.renderer->setColours(h, std::vector<Colour>{red, green, green, red}));
  Image image = drawn(*gl.renderer, frontCamera());
  const Rgb left = pixel(image, 55, 60), right = pixel(image, 105, 60), middle = pixel(image, 80, 60);
  CHECK(left[0] > left[1] + 40);
  CHECK(right[1] > right[0] + 40);
  CHECK(std::abs(middle[0] - middle[1]) < 15);
  CHECK(middle[0] > 60);
  REQUIRE(gl.renderer->setColours(h, {}));
  image = drawn(*gl.renderer, frontCamera());
  CHECK(pixel(image, 55, 60)[2] > pixel(image, 55, 60)[0] + 40);
}

TEST_CASE("Spheres and lines take colours per point") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Colour red{0.9f, 0, 0, 1}, green{0, 0.9f, 0, 1};
  const std::vector<Vec3f> points{{-30, 15, 0}, {30, 15, 0}};
  const Handle spheres = gl.renderer->createSpheres(points, 8.0f, {});
  const std::vector<Vec3f> ends{{-30, -15, 0}, {30, -15, 0}};
  const Handle lines = gl.renderer->createLines(ends, 6.0f, {});
  for (const Handle h : {spheres, lines}) REQUIRE(gl.renderer->setColours(h, std::vector<Colour>{red, green}));
  const Camera camera = frontCamera();
  const Image image = drawn(*gl.renderer, camera);
  for (const double y : {15.0, -15.0}) {
    const Vec3 l = camera.project({-28, y, 0}, 160, 120), r = camera.project({28, y, 0}, 160, 120);
    CHECK(pixel(image, int(l[0]), int(l[1]))[0] > 100);
    CHECK(pixel(image, int(l[0]), int(l[1]))[1] < 80);
    CHECK(pixel(image, int(r[0]), int(r[1]))[1] > 100);
    CHECK(pixel(image, int(r[0]), int(r[1]))[0] < 80);
  }
}

TEST_CASE("A line is as wide as asked, in its own colour, and hidden by what is in front of it") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const float width = GENERATE(1.0f, 4.0f, 9.0f);
  gl.renderer->createLines(std::vector<Vec3f>{{-20, 0, 0}, {20, 0, 0}}, width, {{0.2f, 0.6f, 1.0f, 1}});
  const Camera camera = frontCamera();
  Image image = drawn(*gl.renderer, camera);
  double covered = 0.0;
  for (int y = 0; y < 120; ++y) covered += pixel(image, 80, y)[2] / 255.0;
  CHECK_THAT(covered, WithinAbs(width, 0.3));
  if (width > 2) CHECK(difference(pixel(image, 80, 60), {51, 153, 255}) <= 1);

  const Shape cover = square(10, 5);
  const Handle front = gl.renderer->createMesh(cover.positions, cover.triangles, {{0.9f, 0.1f, 0.1f, 1}});
  image = drawn(*gl.renderer, camera);
  CHECK(pixel(image, 80, 60)[0] > 100);
  CHECK(pixel(image, 80 + 25, 60)[0] < 60);
  // A line within a surface is drawn over it.
  REQUIRE(gl.renderer->setTransform(front, Mat4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1}));
  image = drawn(*gl.renderer, camera);
  CHECK(pixel(image, 80, 60)[2] > pixel(image, 80, 60)[0]);
}

TEST_CASE("A line through the eye's plane is cut, not wrapped around") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  gl.renderer->createLines(std::vector<Vec3f>{{0, -20, 0}, {0, -20, 1000}}, 4.0f, {{1, 1, 1, 1}});
  const Image image = drawn(*gl.renderer, frontCamera());
  int above = 0, below = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) (y < 60 ? above : below) += pixel(image, x, y)[0] > 100;
  CHECK(above == 0);
  CHECK(below > 50);
}

TEST_CASE("A label is drawn above its point, over everything, in its colour with an outline") {
  C3DE_GL_OR_SKIP(gl);
  const Shape wall = square(60, 50);
  gl.renderer->createMesh(wall.positions, wall.triangles, {{0.5f, 0.5f, 0.5f, 1}});
  const Image without = drawn(*gl.renderer, frontCamera(), 320, 240);
  const Handle label = gl.renderer->createLabel({0, 0, 0}, "12.5 mm³ ± 3°", {{1.0f, 0.9f, 0.1f, 1}});
  const Image with = drawn(*gl.renderer, frontCamera(), 320, 240);
  int yellow = 0, dark = 0, below = 0, left = 320, right = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      if (pixel(with, x, y) == pixel(without, x, y)) continue;
      below += y > 120;
      left = std::min(left, x);
      right = std::max(right, x);
      yellow += difference(pixel(with, x, y), {255, 230, 26}) < 40;
      dark += difference(pixel(with, x, y), {8, 8, 8}) < 60;
    }
  CHECK(yellow > 100);
  CHECK(dark > 100);
  CHECK(below == 0);
  CHECK_THAT(0.5 * (left + right), WithinAbs(160.0, 4.0));

  // Another text, other pixels; behind the eye, none.
  REQUIRE(gl.renderer->setLabel(label, {0, 0, 0}, "x"));
  CHECK((drawn(*gl.renderer, frontCamera(), 320, 240).rgb != with.rgb));
  REQUIRE(gl.renderer->setLabel(label, {0, 0, 300}, "x"));
  CHECK((drawn(*gl.renderer, frontCamera(), 320, 240).rgb == without.rgb));
}

TEST_CASE("What is hidden, without opacity, empty or not finite leaves no trace") {
  C3DE_GL_OR_SKIP(gl);
  Renderer &r = *gl.renderer;
  const Image empty = drawn(r, frontCamera());
  const float nan = std::nanf("");
  const Handle h = r.createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 10.0f, {});
  REQUIRE(r.setVisible(h, false));
  r.createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 10.0f, {{1, 1, 1, 0}});
  r.createLabel({0, 0, 0}, "", {});
  r.createLabel({nan, nan, nan}, "lost", {});
  r.createMesh({}, {}, {});
  for (const float opacity : {1.0f, 0.5f}) {
    const Material m{{1, 1, 1, opacity}, true};
    r.createSpheres({}, 1.0f, m);
    r.createLines({}, 1.0f, m);
    r.createSpheres(std::vector<Vec3f>{{nan, nan, nan}}, 10.0f, m);
    r.createMesh(std::vector<Vec3f>(3, Vec3f{nan, nan, nan}), std::vector<Triangle>{{0, 1, 2}}, m);
    r.createLines(std::vector<Vec3f>(2, Vec3f{nan, nan, nan}), 3.0f, m);
  }
  CHECK((drawn(r, frontCamera()).rgb == empty.rgb));
  REQUIRE(r.setVisible(h, true));
  CHECK((drawn(r, frontCamera()).rgb != empty.rgb));
}

namespace {

Legend redToBlue() { return {"Height", "mm", "", 0.0, 8.0, {{1, 0, 0, 1}, {0, 0, 1, 1}}}; }

/// Rows, from the top, whose pixel in some column is of the colour, within a small difference.
std::vector<int> rowsOf(const Image &image, const Rgb &colour) {
  std::vector<int> rows;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (difference(pixel(image, x, y), colour) <= 12) {
        rows.push_back(y);
        break;
      }
  return rows;
}

int columnsDrawn(const Image &image, const Image &without) {
  int leftmost = image.width;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (difference(pixel(image, x, y), pixel(without, x, y)) > 8) leftmost = std::min(leftmost, x);
  return image.width - leftmost;
}

}  // namespace

TEST_CASE("A legend stands at the right edge, its first colour below, its last above") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Image empty = drawn(*gl.renderer, frontCamera(), 400, 320);
  const Handle legend = gl.renderer->createLegend(redToBlue());
  REQUIRE(!legend.isNull());
  const Image image = drawn(*gl.renderer, frontCamera(), 400, 320);
  const auto red = rowsOf(image, {255, 0, 0}), blue = rowsOf(image, {0, 0, 255}),
             between = rowsOf(image, {128, 0, 128});
  REQUIRE((!red.empty() && !blue.empty() && !between.empty()));
  CHECK(blue.back() < between.front());
  CHECK(between.back() < red.front());
  CHECK(red.back() - blue.front() > 120);  // a wide bar
  CHECK(columnsDrawn(image, empty) < 160);
  CHECK(columnsDrawn(image, empty) > 40);

  // Hidden or destroyed, it leaves no pixels.
  gl.renderer->setVisible(legend, false);
  CHECK(drawn(*gl.renderer, frontCamera(), 400, 320).rgb == empty.rgb);
  gl.renderer->setVisible(legend, true);
  CHECK(drawn(*gl.renderer, frontCamera(), 400, 320).rgb == image.rgb);
  gl.renderer->destroy(legend);
  CHECK(drawn(*gl.renderer, frontCamera(), 400, 320).rgb == empty.rgb);
}

TEST_CASE("The style of a picture scales legends and lines, lightens their ground, and is gone afterwards") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  gl.renderer->createLegend(redToBlue());
  gl.renderer->createLines(std::vector<Vec3f>{{-1000, 0, 0}, {1000, 0, 0}}, 2.0f, {{0, 1, 0, 1}});
  const Camera camera = frontCamera();
  const auto count = [](const Image &image, auto isWanted) {
    double found = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) found += isWanted(pixel(image, x, y)) ? 1.0 : 0.0;
    return found;
  };
  const auto isGreen = [](const Rgb &c) { return c[1] > 200 && c[0] < 60 && c[2] < 60; };
  const auto isBar = [](const Rgb &c) { return c[1] < 40 && c[0] + c[2] > 200; };
  const auto isWhite = [](const Rgb &c) { return c[0] > 250 && c[1] > 250 && c[2] > 250; };
  const Image usual = drawn(*gl.renderer, camera, 500, 400);
  CHECK(count(usual, isWhite) < 500.0);

  Renderer::PictureStyle style;
  style.scale = 2.0f;
  style.isLight = true;
  style.background = Renderer::Background{{1, 1, 1, 1}, {1, 1, 1, 1}};
  gl.renderer->setPictureStyle(style);
  const std::uint64_t changes = gl.renderer->changes();
  const Image doubled = drawn(*gl.renderer, camera, 1000, 800);
  CHECK(gl.renderer->changes() == changes);
  // Twice as wide, in a picture that is twice as wide: four times the pixels.
  CHECK(count(doubled, isGreen) / count(usual, isGreen) == Approx(4.0).epsilon(0.05));
  CHECK(count(doubled, isBar) / count(usual, isBar) == Approx(4.0).epsilon(0.08));
  CHECK(count(doubled, isWhite) > 0.8 * 1000 * 800);

  gl.renderer->setPictureStyle({});
  const Image again = drawn(*gl.renderer, camera, 500, 400);
  CHECK(again.rgb == usual.rgb);
}

TEST_CASE("Two legends stand below each other, and a picture too small for one has none") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  const Image small = drawn(*gl.renderer, frontCamera(), 90, 60);
  gl.renderer->createLegend(redToBlue());
  Legend green = redToBlue();
  green.colours = {{0, 1, 0, 1}, {1, 1, 0, 1}};
  gl.renderer->createLegend(green);
  const Image image = drawn(*gl.renderer, frontCamera(), 400, 480);
  REQUIRE(!rowsOf(image, {0, 255, 0}).empty());
  CHECK(rowsOf(image, {255, 0, 0}).back() < rowsOf(image, {255, 255, 0}).front());
  CHECK(drawn(*gl.renderer, frontCamera(), 90, 60).rgb == small.rgb);
}

TEST_CASE("A legend without two colours or with a range that does not grow is refused") {
  const auto renderer = createNullRenderer();
  Legend legend = redToBlue();
  const Handle made = renderer->createLegend(legend);
  CHECK(!made.isNull());
  CHECK(renderer->setLegend(made, legend));
  legend.high = legend.low;
  CHECK(renderer->createLegend(legend).isNull());
  CHECK(!renderer->setLegend(made, legend));
  legend = redToBlue();
  legend.colours.resize(1);
  CHECK(renderer->createLegend(legend).isNull());
  CHECK(!renderer->setColours(made, std::vector<Colour>{{1, 0, 0, 1}}));
  CHECK(!renderer->setLegend(renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 1.0f, {}), redToBlue()));
}

TEST_CASE("What tools show of a hand is seen through what hides it and beyond cuts, and nothing else is") {
  C3DE_GL_OR_SKIP(gl);
  setBlackBackground(*gl.renderer);
  // A wall before a sphere and a line; the middle is in the middle of the picture.
  gl.renderer->createMesh(std::vector<Vec3f>{{-90, -90, 30}, {90, -90, 30}, {0, 120, 30}},
                          std::vector<Triangle>{{0, 1, 2}}, {{0, 0, 1, 1}, true});
  Material mark{{1, 1, 0, 1}};
  const Handle sphere = gl.renderer->createSpheres(std::vector<Vec3f>{{0, 0, 0}}, 12.0f, mark);
  const Handle line = gl.renderer->createLines(std::vector<Vec3f>{{20, 0, 0}, {60, 0, 0}}, 6.0f, mark);
  const auto isYellow = [](const Image &image, int x) {
    const Rgb c = pixel(image, x, 60);
    return c[0] > 60 && c[1] > 60 && c[2] < 60;
  };
  const auto seen = [&] {
    const Image image = drawn(*gl.renderer, frontCamera());
    return std::pair{isYellow(image, 80), isYellow(image, 110)};
  };
  CHECK(seen() == std::pair{false, false});
  ImageScene cut;
  cut.cuts = {{{0, 0, -40}, {0, 0, 1}}};
  cut.cutsProxies = true;
  gl.renderer->images()->setScene(cut);
  CHECK(seen() == std::pair{false, false});  // everything is beyond it, the wall as well
  mark.inSlices = true;
  gl.renderer->setMaterial(sphere, mark);
  gl.renderer->setMaterial(line, mark);
  CHECK(seen() == std::pair{true, true});
  gl.renderer->images()->setScene({});
  CHECK(seen() == std::pair{true, true});
}
