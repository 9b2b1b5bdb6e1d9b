// SPDX-License-Identifier: Apache-2.0
// Slices of images: the mapping from voxels to pixels, and overlays.
#include <cmath>
#include <filesystem>

#include "gl_fixture.h"
#include "phantom.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kSide = 144;  // half a millimetre per pixel

/// A view of 72 mm around the centre.
SlicePlane planeAt(const Vec3 &centre, const Vec3 &right, const Vec3 &down) {
  const double scale = 0.5, half = 0.5 * kSide * scale;
  return {centre - half * right - half * down, scale * right, scale * down};
}

ImageDisplay lookAt(Handle image) {
  ImageDisplay look;
  look.image = image;
  look.window = 1000.0;
  look.level = 200.0;
  return look;
}

Image slice(Renderer &renderer, const ImageDisplay &look, const SlicePlane &plane) {
  auto image = renderer.images()->drawSliceToImage(look, plane, kSide, kSide);
  if (!image) FAIL(image.error().message);
  return std::move(*image);
}

Handle added(Expected<Handle> handle) {
  if (!handle) FAIL(handle.error().message);
  return *handle;
}

void save(const Image &image, const char *name) {
  const auto written = writePng((testOutputFolder() / name).string(), image);
  if (!written) FAIL(written.error().message);
}

/// Whether the pixels show the letter: columns to the right, rows downwards, 3 mm (6 pixels) each, around the middle.
bool reads(const Image &image, char letter) {
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 5; ++column) {
      const int x = kSide / 2 + (column - 2) * 6, y = kSide / 2 + (row - 3) * 6;
      const bool isInk = letterRows(letter)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#';
      if ((pixel(image, x, y)[0] > 200) != isInk) return false;
    }
  return true;
}

int mostDifferent(const Image &a, const Image &b) {
  int most = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) most = std::max(most, std::abs(int(a.rgb[i]) - int(b.rgb[i])));
  return most;
}

constexpr Vec3 kLeft{1, 0, 0}, kBack{0, 1, 0}, kDown{0, 0, -1};

}  // namespace

TEST_CASE("The letters of the phantom read right, however its voxels lie in memory", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  int number = 0;
  for (const auto &[name, size, place] : c3de::test::letterGrids()) {
    const Phantom phantom = makePhantom(size, place);
    const ImageDisplay look = lookAt(added(gl.renderer->images()->addImage(phantom.image())));
    const Image left = slice(*gl.renderer, look, planeAt({23, 0, 0}, kBack, kDown));
    const Image front = slice(*gl.renderer, look, planeAt({0, -23, 0}, kLeft, kDown));
    const Image top = slice(*gl.renderer, look, planeAt({0, 0, 23}, kLeft, kBack));
    CAPTURE(name);
    CHECK(reads(left, 'L'));
    CHECK(reads(front, 'A'));
    CHECK(reads(top, 'S'));
    // A mirrored view is no letter.
    CHECK_FALSE(reads(slice(*gl.renderer, look, planeAt({23, 0, 0}, Vec3{0, -1, 0}, kDown)), 'L'));
    save(left, ("slice_L" + std::to_string(number) + ".png").c_str());
    save(front, ("slice_A" + std::to_string(number) + ".png").c_str());
    save(top, ("slice_S" + std::to_string(number) + ".png").c_str());
    ++number;
  }
}

TEST_CASE("A pixel is as grey as the value that lies at its world point, in every voxel type", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  // value = 10 i + j/4, exact under linear interpolation.
  const std::array<std::size_t, 3> size{8, 9, 3};
  const Mat4 place{2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, -7, -12, -4, 1};
  const auto check = [&](VoxelType type, const void *voxels, double slope, double intercept) {
    ImageDisplay look = lookAt(added(gl.renderer->images()->addImage({{size, place}, type, voxels, slope, intercept})));
    look.window = 100.0;
    look.level = 40.0;
    const Image image = slice(*gl.renderer, look, planeAt({0, 0, 0}, kLeft, kBack));
    for (const auto &[x, y] : {std::pair{72, 72}, {64, 60}, {80, 90}, {62, 71}}) {
      const Vec3 world{0.5 * (x + 0.5) - 36.0, 0.5 * (y + 0.5) - 36.0, 0.0};
      const double value = 10.0 * (world[0] + 7.0) / 2.0 + 0.25 * (world[1] + 12.0) / 3.0;
      const double grey = 255.0 * std::clamp((value + 10.0) / 100.0, 0.0, 1.0);
      CAPTURE(static_cast<int>(type), x, y);
      // 8-bit textures may be filtered in 8 bits: one of their steps is 4 greys here; otherwise rounding.
      const bool isCoarse = type == VoxelType::uint8 || type == VoxelType::int8;
      CHECK_THAT(pixel(image, x, y)[0], WithinAbs(grey, isCoarse ? 4.0 : 1.0));
    }
  };
  const auto fill = [&]<class T>(T, double slope, double intercept) {
    std::vector<T> voxels;
    for (std::size_t k = 0; k < size[2]; ++k)
      for (std::size_t j = 0; j < size[1]; ++j)
        for (std::size_t i = 0; i < size[0]; ++i)
          voxels.push_back(
              static_cast<T>((10.0 * static_cast<double>(i) + 0.25 * static_cast<double>(j) - intercept) / slope));
    return voxels;
  };
  check(VoxelType::int16, fill(std::int16_t{}, 0.25, -1024.0).data(), 0.25, -1024.0);
  check(VoxelType::uint16, fill(std::uint16_t{}, 0.25, 0.0).data(), 0.25, 0.0);
  check(VoxelType::float32, fill(0.0f, 1.0, 0.0).data(), 1.0, 0.0);
  check(VoxelType::float64, fill(0.0, 1.0, 5.0).data(), 1.0, 5.0);
  check(VoxelType::int32, fill(std::int32_t{}, 0.25, 0.0).data(), 0.25, 0.0);
  check(VoxelType::uint32, fill(std::uint32_t{}, 0.25, 0.0).data(), 0.25, 0.0);
  check(VoxelType::uint8, fill(std::uint8_t{}, 0.5, 0.0).data(), 0.5, 0.0);
  check(VoxelType::int8, fill(std::int8_t{}, 1.0, 40.0).data(), 1.0, 40.0);
}

TEST_CASE("The nearest voxel is shown as a whole when interpolation is off", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  const std::vector<std::uint8_t> voxels{0, 255};
  ImageDisplay look = lookAt(added(gl.renderer->images()->addImage(
      {{{2, 1, 1}, {20, 0, 0, 0, 0, 40, 0, 0, 0, 0, 40, 0, -10, 0, 0, 1}}, VoxelType::uint8, voxels.data()})));
  look.window = 255;
  look.level = 127.5;
  look.isSmooth = false;
  const Image image = slice(*gl.renderer, look, planeAt({}, kLeft, kBack));
  CHECK(pixel(image, 70, 72)[0] == 0);
  CHECK(pixel(image, 74, 72)[0] == 255);
  CHECK(pixel(image, 72 + 39, 72)[0] == 255);
  CHECK(pixel(image, 72 + 41, 72)[0] == 0);  // half a voxel beyond the last centre the image ends
}

TEST_CASE("Labels lie over the image on their own grid, in their colours, and can be hidden", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  const Phantom phantom = plainPhantom();
  // Coarser, and stored from left to right in reverse.
  const Phantom coarse = makePhantom({24, 24, 24}, {-3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 34.5, -34.5, -34.5, 1});
  ImageDisplay look = lookAt(added(gl.renderer->images()->addImage(phantom.image())));
  look.labels = added(gl.renderer->images()->addLabels(coarse.place(), coarse.labels));
  look.labelOpacity = 0.5f;
  const std::vector<std::pair<std::uint16_t, Colour>> red{{1, {0, 1, 0, 0}}, {2, {1, 0, 0, 1}}};
  REQUIRE(gl.renderer->images()->setLabelColours(look.labels, red));
  const SlicePlane plane = planeAt({23, 0, 0}, kBack, kDown);
  const Image image = slice(*gl.renderer, look, plane);
  save(image, "slice_labels.png");
  const Rgb ink = pixel(image, kSide / 2 - 15, kSide / 2);  // the stem of the L
  CHECK(ink[0] > 250);
  CHECK_THAT(ink[1], WithinAbs(128, 2));
  const Rgb block = pixel(image, kSide / 2 + 2 * 6, kSide / 2);  // label 1 is hidden
  CHECK(block[0] == block[1]);
  look.labelOpacity = 0.0f;
  CHECK(reads(slice(*gl.renderer, look, plane), 'L'));
}

TEST_CASE("A label fills its voxel, from half a voxel before its centre to half a voxel behind", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  const GridGeometry place{{2, 1, 1}, {20, 0, 0, 0, 0, 40, 0, 0, 0, 0, 40, 0, -10, 0, 0, 1}};
  const std::vector<std::uint8_t> black{0, 0};
  ImageDisplay look = lookAt(added(gl.renderer->images()->addImage({place, VoxelType::uint8, black.data()})));
  look.window = 255;
  look.level = 127.5;
  look.labelOpacity = 1.0f;
  look.labels = added(gl.renderer->images()->addLabels(place, std::vector<std::uint16_t>{300, 65535}));
  gl.renderer->images()->setLabelColours(
      look.labels, std::vector<std::pair<std::uint16_t, Colour>>{{300, {1, 0, 0, 1}}, {65535, {0, 1, 0, 1}}});
  const Image image = slice(*gl.renderer, look, planeAt({}, kLeft, kBack));
  const Rgb red{255, 0, 0}, green{0, 255, 0}, none{0, 0, 0};
  CHECK(pixel(image, 72 - 41, 72) == none);
  CHECK(pixel(image, 72 - 39, 72) == red);
  CHECK(pixel(image, 71, 72) == red);
  CHECK(pixel(image, 72, 72) == green);
  CHECK(pixel(image, 72 + 39, 72) == green);
  CHECK(pixel(image, 72 + 41, 72) == none);
}

TEST_CASE("A displacement shows the material that is now there, image and labels alike", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  const Phantom phantom = plainPhantom();
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  look.labels = added(images.addLabels(phantom.place(), phantom.labels));
  images.setLabelColours(look.labels, std::vector<std::pair<std::uint16_t, Colour>>{{2, {1, 0, 0, 1}}});
  const SlicePlane plane = planeAt({23, 0, 0}, kBack, kDown);
  const Image still = slice(*gl.renderer, look, plane);

  // Everything has moved 5 mm to the back: a separate grid, 10 mm apart, beyond the image.
  const std::array<std::size_t, 3> nodes{13, 13, 13};
  const GridGeometry grid{nodes, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, -60, -60, -60, 1}};
  std::vector<float> u;
  for (std::size_t i = 0; i < 13 * 13 * 13; ++i) u.insert(u.end(), {0.0f, 5.0f, 0.0f});
  look.displacement = added(images.addDisplacement(grid, u));
  const Image moved = slice(*gl.renderer, look, plane);
  save(moved, "slice_moved.png");
  int most = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 10; x < kSide; ++x) most = std::max(most, difference(pixel(moved, x, y), pixel(still, x - 10, y)));
  CHECK(most <= 2);  // the last bits of interpolation weights
  CHECK(mostDifferent(moved, still) > 100);

  // |u| as colours, blue to yellow from 0 to 10 mm.
  look.overlay = Overlay::shift;
  look.overlayOpacity = 1.0f;
  images.setOverlayColours(std::vector<Colour>{{0, 0, 1, 1}, {1, 1, 0, 1}});
  const Rgb map = pixel(slice(*gl.renderer, look, plane), 72, 72);
  CHECK(difference(map, {128, 128, 128}) <= 2);
  look.overlayLow = 6.0;  // below the range there is no overlay
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), moved) == 0);
}

TEST_CASE("A field is laid over where it has a value and a body is, in the colours of its range", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  const Phantom phantom = plainPhantom();
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  const SlicePlane plane = planeAt({23, 0, 0}, kBack, kDown);
  const std::array<std::size_t, 3> nodes{13, 13, 13};
  const GridGeometry grid{nodes, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, -60, -60, -60, 1}};
  look.displacement = added(images.addDisplacement(grid, std::vector<float>(3 * 2197), std::vector<float>(2197)));
  look.leastGap = 5.0;
  const Image plain = slice(*gl.renderer, look, plane);
  // 3 in front of the middle (y < 0), which is the left half of the view; nothing behind.
  std::vector<float> values(2197, std::nanf(""));
  for (std::size_t k = 0; k < 13; ++k)
    for (std::size_t j = 0; j <= 6; ++j)
      for (std::size_t i = 0; i < 13; ++i) values[i + 13 * (j + 13 * k)] = 3.0f;
  look.overlay = Overlay::field;
  look.overlayLow = 2.0;
  look.overlayHigh = 4.0;
  look.overlayOpacity = 1.0f;
  images.setOverlayColours(std::vector<Colour>{{0, 0, 1, 1}, {1, 1, 0, 1}});
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), plain) == 0);  // none yet
  REQUIRE(images.setField(look.displacement, values));
  Image shown = slice(*gl.renderer, look, plane);
  CHECK(difference(pixel(shown, 40, 72), {128, 128, 128}) <= 2);
  // Between the last points with a value and the first without, the value is that of the points with one.
  CHECK(difference(pixel(shown, 80, 72), {128, 128, 128}) <= 2);
  CHECK(pixel(shown, 110, 72) == pixel(plain, 110, 72));
  // Only where a body is: of the upper half.
  std::vector<std::uint8_t> bodies(phantom.place().size[0] * phantom.place().size[1] * phantom.place().size[2], 0);
  std::size_t v = 0;
  for (std::size_t k = 0; k < phantom.place().size[2]; ++k)
    for (std::size_t j = 0; j < phantom.place().size[1]; ++j)
      for (std::size_t i = 0; i < phantom.place().size[0]; ++i, ++v) {
        const Vec3 at = transformPoint(phantom.place().worldFromIndex, {double(i), double(j), double(k)});
        bodies[v] = at[2] > 0 ? 255 : 0;
      }
  look.bodies = added(images.addImage({phantom.place(), VoxelType::uint8, bodies.data()}));
  shown = slice(*gl.renderer, look, plane);
  CHECK(difference(pixel(shown, 40, 40), {128, 128, 128}) <= 2);
  CHECK(pixel(shown, 40, 100) == pixel(plain, 40, 100));
  // Beyond the ends of the range the colours of the ends.
  look.overlayLow = 5.0;
  look.overlayHigh = 6.0;
  CHECK(difference(pixel(slice(*gl.renderer, look, plane), 40, 40), {0, 0, 255}) <= 2);
  REQUIRE(images.setField(look.displacement, {}));
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), plain) == 0);
}

TEST_CASE("No displacement and one of zeros give the same pixels to the bit, outside its grid it is zero", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom =
      makePhantom({130, 130, 70}, {0.6, 0.5, 0.1, 0, -0.5, 0.6, 0, 0, 0.05, 0, 1.1, 0, -8, -70, -43, 1});
  ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  look.labels = added(images.addLabels(phantom.place(), phantom.labels));
  images.setLabelColours(look.labels, std::vector<std::pair<std::uint16_t, Colour>>{{2, {1, 0, 0, 1}}});
  const Vec3 right{0.8, 0.6, 0}, down{0.36, -0.48, -0.8};
  const SlicePlane plane = planeAt({3, -2, 5}, right, down);
  const Image still = slice(*gl.renderer, look, plane);
  const GridGeometry grid{{5, 6, 7}, {4, 1, 0, 0, 0, 5, 0, 0, 0, 0, 3, 0, 10, -15, -15, 1}};
  std::vector<float> u(3 * 5 * 6 * 7, 0.0f);
  look.displacement = added(images.addDisplacement(grid, u));
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), still) == 0);
  look.overlay = Overlay::shift;
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), still) == 0);
  look.overlay = Overlay::none;

  for (std::size_t i = 1; i < u.size(); i += 3) u[i] = 3.0f;
  REQUIRE(images.setDisplacement(look.displacement, u));
  const Image moved = slice(*gl.renderer, look, plane);
  const Mat4 nodeFromWorld = [&] {
    Mat4 inverse = kIdentity4;  // of the lower triangular matrix above
    inverse[0] = 1.0 / 4.0;
    inverse[1] = -1.0 / 20.0;
    inverse[5] = 1.0 / 5.0;
    inverse[10] = 1.0 / 3.0;
    const Vec3 origin{10, -15, -15};
    inverse[12] = -inverse[0] * origin[0];
    inverse[13] = -inverse[1] * origin[0] - inverse[5] * origin[1];
    inverse[14] = -inverse[10] * origin[2];
    return inverse;
  }();
  int outside = 0, inside = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Vec3 world = plane.origin + (x + 0.5) * plane.right + (y + 0.5) * plane.down;
      const Vec3 node = transformPoint(nodeFromWorld, world);
      const bool isInside =
          node[0] > -0.1 && node[1] > -0.1 && node[2] > -0.1 && node[0] < 4.1 && node[1] < 5.1 && node[2] < 6.1;
      (isInside ? inside : outside) += pixel(moved, x, y) != pixel(still, x, y);
    }
  CHECK(outside == 0);
  CHECK(inside > 20);
  CHECK_FALSE(images.setDisplacement(look.displacement, std::span<const float>(u).first(30)));
}

TEST_CASE("What cannot be an image is refused by name, and a removed one shows black", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom = plainPhantom();
  ImageVoxels bad = phantom.image();
  bad.place.size = {0, 5, 5};
  CHECK_THAT(images.addImage(bad).error().message, Contains("0 x 5 x 5"));
  bad = phantom.image();
  bad.place.worldFromIndex[0] = bad.place.worldFromIndex[1] = bad.place.worldFromIndex[2] = 0.0;
  CHECK_THAT(images.addImage(bad).error().message, Contains("determinant"));
  bad = phantom.image();
  bad.slope = 0.0;
  CHECK_FALSE(images.addImage(bad).has_value());
  CHECK_FALSE(images.addLabels(phantom.place(), std::span(phantom.labels).first(10)).has_value());
  const ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  CHECK(images.remove(look.image));
  CHECK_FALSE(images.remove(look.image));
  const Image image = slice(*gl.renderer, look, planeAt({}, kLeft, kBack));
  CHECK(pixel(image, 72, 72) == Rgb{0, 0, 0});
}

TEST_CASE("Places that a body has left are hatched where a gap leads to it, and nowhere else", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom = plainPhantom();
  ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  // Bodies on the image's left half; the gap is defined at half of its height, beyond the grid everything has moved
  // away.
  const GridGeometry place = phantom.place();
  const std::array<std::size_t, 3> &n = place.size;
  std::vector<std::uint8_t> bodies(n[0] * n[1] * n[2], 0);
  for (std::size_t v = 0; v < bodies.size(); ++v) bodies[v] = v % n[0] >= n[0] / 2 ? 255 : 0;
  const GridGeometry grid{{13, 13, 5}, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 5, 0, -60, -60, -10, 1}};
  std::vector<float> u(3 * 13 * 13 * 5, 0.0f), gaps(13 * 13 * 5, 0.0f);
  const SlicePlane plane = planeAt({0, 0, 0}, kLeft, kDown);
  const Image still = slice(*gl.renderer, look, plane);
  look.bodies = added(images.addImage({place, VoxelType::uint8, bodies.data()}));
  look.leastGap = 2.0;

  look.displacement = added(images.addDisplacement(grid, u));  // without gaps nothing is marked
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), still) == 0);
  images.remove(look.displacement);
  look.displacement = added(images.addDisplacement(grid, u, gaps));
  const auto isHatch = [](const Rgb &p) { return difference(p, {5, 5, 5}) <= 1 || difference(p, {51, 77, 82}) <= 1; };
  const auto count = [&](const char *name, bool left, bool within) {
    const Image image = slice(*gl.renderer, look, plane);
    save(image, name);
    int found = 0, others = 0;
    // Two pixels are a millimetre; the middle of the picture is the origin. The border of the grid is excluded.
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double z = -0.5 * (y + 0.5 - 72), across = 0.5 * (x + 0.5 - 72);
        if (std::abs(std::abs(z) - 10.0) < 0.6 || std::abs(across) > 30.0 || std::abs(across) < 2.0 ||
            std::abs(z) > 30.0)
          continue;
        if ((across > 0) != left || (std::abs(z) < 10.0) != within) continue;
        (isHatch(pixel(image, x, y)) ? found : others) += 1;
      }
    return std::pair(found, others);
  };
  CHECK(count("slice_left.png", true, true).first == 0);
  CHECK(count("slice_left.png", true, false).second == 0);
  for (float &gap : gaps) gap = 3.0f;
  REQUIRE(images.setDisplacement(look.displacement, u, gaps));
  CHECK(count("slice_left_all.png", true, true).second == 0);
  CHECK(count("slice_left_all.png", false, true).first == 0);
  CHECK(count("slice_left_all.png", false, false).first == 0);
  CHECK_FALSE(images.setDisplacement(look.displacement, u));
}

TEST_CASE("A colour image shows its colours, through window and level, moved like grey values", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  // A board of four colours, 18 mm each side of the middle.
  constexpr std::size_t kCount = 4;
  const std::array<std::array<std::uint8_t, 4>, 4> board{
      {{200, 0, 0, 255}, {0, 200, 0, 255}, {0, 0, 200, 255}, {60, 120, 180, 0}}};
  std::vector<std::uint8_t> grey(kCount * kCount * kCount, 100);
  std::vector<std::array<std::uint8_t, 4>> colours;
  for (std::size_t v = 0; v < grey.size(); ++v)
    colours.push_back(board[(v % kCount / 2) + 2 * (v / kCount % kCount / 2)]);
  ImageVoxels image;
  image.place.size = {kCount, kCount, kCount};
  image.place.worldFromIndex = {9, 0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0, -13.5, -13.5, -13.5, 1};
  image.type = VoxelType::uint8;
  image.voxels = grey.data();
  image.colours = colours.data();
  ImageDisplay look;
  look.image = added(gl.renderer->images()->addImage(image));
  look.window = 255.0;
  look.level = 127.5;
  look.isSmooth = false;
  const SlicePlane plane = planeAt({0, 0, 2}, kLeft, kBack);
  const auto shows = [&](const Image &picture, double dx_mm, double dy_mm, const std::array<int, 3> &expected) {
    const auto found = pixel(picture, kSide / 2 + static_cast<int>(2 * dx_mm), kSide / 2 + static_cast<int>(2 * dy_mm));
    CAPTURE(dx_mm, dy_mm, int(found[0]), int(found[1]), int(found[2]));
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(int(found[c]) - expected[c]) <= 1);
  };
  const Image plain = slice(*gl.renderer, look, plane);
  save(plain, "colours.png");
  shows(plain, -9, -9, {200, 0, 0});
  shows(plain, 9, -9, {0, 200, 0});
  shows(plain, -9, 9, {0, 0, 200});
  shows(plain, 9, 9, {60, 120, 180});
  shows(plain, 30, 0, {0, 0, 0});
  look.window = 127.5;
  shows(slice(*gl.renderer, look, plane), 9, 9, {0, 113, 233});  // 2 (c - 127.5) + 127.5
  look.window = 255.0;
  const std::vector<float> shift{18, 0, 0, 18, 0, 0, 18, 0, 0, 18, 0, 0, 18, 0, 0, 18, 0, 0, 18, 0, 0, 18, 0, 0};
  look.displacement = added(gl.renderer->images()->addDisplacement(
      {{2, 2, 2}, {100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, -50, -50, -50, 1}}, shift));
  shows(slice(*gl.renderer, look, plane), 9, -9, {200, 0, 0});
}

TEST_CASE("What stays is not displaced, and what has moved away from it leaves a gap", "[slices]") {
  C3DE_GL_OR_SKIP(gl);
  ImageRenderer &images = *gl.renderer->images();
  const Phantom phantom = plainPhantom();
  ImageDisplay look = lookAt(added(images.addImage(phantom.image())));
  const SlicePlane plane = planeAt({0, 0, 0}, kLeft, kDown);
  const Image still = slice(*gl.renderer, look, plane);
  // Everything moves 6 mm to the left; the right half of the image is static. No bodies, no gaps between them.
  const GridGeometry place = phantom.place(),
                     grid{{13, 13, 5}, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 20, 0, -60, -60, -40, 1}};
  const std::array<std::size_t, 3> &n = place.size;
  std::vector<std::uint8_t> stays(n[0] * n[1] * n[2], 0);
  for (std::size_t v = 0; v < stays.size(); ++v) stays[v] = v % n[0] < n[0] / 2 ? 64 : 0;
  std::vector<float> u, gaps(13 * 13 * 5, 0.0f);
  for (std::size_t i = 0; i < 13 * 13 * 5; ++i) u.insert(u.end(), {6.0f, 0.0f, 0.0f});
  look.leastGap = 2.0;
  look.displacement = added(images.addDisplacement(grid, u, gaps));
  const Image bent = slice(*gl.renderer, look, plane);
  look.bodies = added(images.addImage({place, VoxelType::uint8, stays.data()}));
  CHECK(mostDifferent(slice(*gl.renderer, look, plane), bent) == 0);  // no static region is set
  look.hasFixedRegions = true;
  const Image shown = slice(*gl.renderer, look, plane);
  save(shown, "slice_still.png");
  const auto isHatch = [](const Rgb &p) { return difference(p, {5, 5, 5}) <= 1 || difference(p, {51, 77, 82}) <= 1; };
  int moved = 0, hatched = 0, kept = 0;
  for (int y = 16; y < kSide - 16; ++y)
    for (int x = 16; x < kSide - 16; ++x) {
      const double across = 0.5 * (x + 0.5 - 72);
      // The border between the halves is as coarse as a voxel.
      if (across < -3.0) {
        REQUIRE(difference(pixel(shown, x, y), pixel(still, x, y)) == 0);
        ++kept;
      } else if (across > 3.0 && across < 4.0) {
        hatched += isHatch(pixel(shown, x, y)) ? 1 : 0;
      } else if (across > 9.5) {
        REQUIRE(difference(pixel(shown, x, y), pixel(bent, x, y)) == 0);
        ++moved;
      }
    }
  CHECK((kept > 1000 && moved > 1000));
  CHECK(hatched == 2 * (kSide - 32));

  // Of rigid tissue: tissue moving away from it leaves no gap beyond that of the displacement, and rigid tissue shows
  // its own position.
  for (std::uint8_t &v : stays) v = v == 64 ? 96 : 0;
  look.bodies = added(images.addImage({place, VoxelType::uint8, stays.data()}));
  const Image attached = slice(*gl.renderer, look, plane);
  look.displacement = added(images.addDisplacement(grid, u, std::vector<float>(gaps.size(), 5.0f)));
  const Image torn = slice(*gl.renderer, look, plane);
  int own = 0;
  hatched = 0;
  for (int y = 16; y < kSide - 16; ++y)
    for (int x = 16; x < kSide - 16; ++x) {
      const double across = 0.5 * (x + 0.5 - 72);
      if (across < -3.0 || (across > 3.0 && across < 4.0)) {
        REQUIRE(difference(pixel(attached, x, y), pixel(still, x, y)) == 0);
        ++own;
      }
      if (across > 3.0 && across < 4.0) hatched += isHatch(pixel(torn, x, y)) ? 1 : 0;
      if (across < -3.0) REQUIRE(difference(pixel(torn, x, y), pixel(still, x, y)) == 0);
    }
  CHECK(own > 1000);
  CHECK(hatched == 2 * (kSide - 32));
}
