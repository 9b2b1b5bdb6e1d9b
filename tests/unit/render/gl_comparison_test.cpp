// SPDX-License-Identifier: Apache-2.0
// A second image over the first one in slices.
#include <cmath>

#include "gl_fixture.h"
#include "phantom.h"

using namespace c3de;
using namespace c3de::render;
using namespace c3de::render::test;

namespace {

constexpr int kSide = 144;  // half a millimetre per pixel
constexpr Vec3 kLeft{1, 0, 0}, kBack{0, 1, 0};

/// An axial view of 72 mm around a point.
SlicePlane planeAt(const Vec3 &centre) {
  const double scale = 0.5, half = 0.5 * kSide * scale;
  return {centre - half * kLeft - half * kBack, scale * kLeft, scale * kBack};
}

Handle added(Expected<Handle> handle) {
  if (!handle) FAIL(handle.error().message);
  return *handle;
}

Image slice(Renderer &renderer, const ImageDisplay &look, const SlicePlane &plane) {
  auto image = renderer.images()->drawSliceToImage(look, plane, kSide, kSide);
  if (!image) FAIL(image.error().message);
  return std::move(*image);
}

double meanDifference(const Image &a, const Image &b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int(a.rgb[i]) - int(b.rgb[i]));
  return sum / static_cast<double>(a.rgb.size());
}

/// 40 degrees about z, then a shift; and back.
Mat4 rigid(double degrees, const Vec3 &shift) {
  const double c = std::cos(degrees * 3.14159265358979 / 180.0), s = std::sin(degrees * 3.14159265358979 / 180.0);
  return {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, shift[0], shift[1], shift[2], 1};
}
Mat4 rigidBack(double degrees, const Vec3 &shift) {
  return multiply(rigid(-degrees, {}), Mat4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -shift[0], -shift[1], -shift[2], 1});
}

/// A block of 60 x 60 x 20 mm of one value around the origin.
struct Block {
  std::vector<std::int16_t> voxels;
  GridGeometry place;
  Block(std::int16_t value, std::size_t side) {
    const double step = 60.0 / static_cast<double>(side), first = -30.0 + 0.5 * step;
    place = {{side, side, 2}, {step, 0, 0, 0, 0, step, 0, 0, 0, 0, 10, 0, first, first, -5, 1}};
    voxels.assign(side * side * 2, value);
  }
  [[nodiscard]] ImageVoxels image() const { return {place, VoxelType::int16, voxels.data(), 1.0, 0.0}; }
};

ImageDisplay lookAt(Handle first, Handle second) {
  ImageDisplay look;
  look.image = first;
  look.window = 1000.0;
  look.level = 500.0;
  look.comparison.image = second;
  look.comparison.window = 200.0;
  look.comparison.level = 100.0;
  return look;
}

}  // namespace

TEST_CASE("A second image at another position is shown where its rigid motion brings it", "[comparison]") {
  C3DE_GL_OR_SKIP(gl);
  Phantom phantom = plainPhantom();
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look;
  look.image = added(images.addImage(phantom.image()));
  look.window = 1000.0;
  look.level = 200.0;
  const Image alone = slice(*gl.renderer, look, planeAt({0, 0, 23}));
  // The same voxels, turned and shifted.
  const Vec3 shift{13, -21, 4};
  phantom.worldFromIndex = multiply(rigid(40.0, shift), phantom.worldFromIndex);
  look.comparison.image = added(images.addImage(phantom.image()));
  look.comparison.window = look.window;
  look.comparison.level = look.level;
  look.comparison.weight = 1.0f;
  const Image unaligned = slice(*gl.renderer, look, planeAt({0, 0, 23}));
  look.comparison.worldFromSecond = rigidBack(40.0, shift);
  const Image aligned = slice(*gl.renderer, look, planeAt({0, 0, 23}));
  CHECK(meanDifference(alone, unaligned) > 5.0);
  CHECK(meanDifference(alone, aligned) < 0.05);
  // At weight 0 the first is alone, to the bit.
  look.comparison.weight = 0.0f;
  CHECK(slice(*gl.renderer, look, planeAt({0, 0, 23})).rgb == alone.rgb);
  // A removed image is none.
  images.remove(look.comparison.image);
  look.comparison.weight = 1.0f;
  CHECK(slice(*gl.renderer, look, planeAt({0, 0, 23})).rgb == alone.rgb);
}

TEST_CASE("Blending gives the weighted mean of both greys, each through its own window", "[comparison]") {
  C3DE_GL_OR_SKIP(gl);
  // 0.3 of white, and 0.8 of white on another grid.
  const Block first(300, 60), second(160, 24);
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look = lookAt(added(images.addImage(first.image())), added(images.addImage(second.image())));
  for (const float weight : {0.0f, 0.25f, 0.5f, 1.0f}) {
    look.comparison.weight = weight;
    const Image image = slice(*gl.renderer, look, planeAt({0, 0, 0}));
    CHECK_THAT(pixel(image, 72, 72)[0], WithinAbs(255.0 * ((1.0 - weight) * 0.3 + weight * 0.8), 1.5));
  }
  // Beyond the second image the first one is alone, and beyond both it is black.
  look.comparison.weight = 1.0f;
  look.comparison.worldFromSecond = rigid(0.0, {30, 0, 0});
  const Image image = slice(*gl.renderer, look, planeAt({0, 0, 0}));
  CHECK_THAT(pixel(image, 40, 72)[0], WithinAbs(255.0 * 0.3, 1.5));
  CHECK_THAT(pixel(image, 100, 72)[0], WithinAbs(255.0 * 0.8, 1.5));
  CHECK(pixel(image, 2, 72)[0] == 0);
}

TEST_CASE("Squares of a checkerboard have their size in mm, and stay on the image when the view moves",
          "[comparison]") {
  C3DE_GL_OR_SKIP(gl);
  const Block first(300, 60), second(160, 24);
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look = lookAt(added(images.addImage(first.image())), added(images.addImage(second.image())));
  look.comparison.isCheckerboard = true;
  look.comparison.square_mm = 8.0;
  for (const Vec3 &centre : {Vec3{0, 0, 0}, Vec3{3, -5, 2}}) {
    const SlicePlane plane = planeAt(centre);
    const Image image = slice(*gl.renderer, look, plane);
    std::size_t ofSecond = 0, seen = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Vec3 at = plane.origin + (x + 0.5) * plane.right + (y + 0.5) * plane.down;
        if (std::abs(at[0]) > 29.0 || std::abs(at[1]) > 29.0) continue;
        const double u = at[0] / 8.0, v = at[1] / 8.0;
        // Next to an edge a pixel may be of either.
        if (std::abs(u - std::round(u)) < 0.02 || std::abs(v - std::round(v)) < 0.02) continue;
        const bool isSecond = (static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v))) % 2 != 0;
        ++seen;
        if (std::abs(pixel(image, x, y)[0] - 255.0 * (isSecond ? 0.8 : 0.3)) < 1.5) ++ofSecond;
      }
    CHECK(seen > 10000);
    CHECK(ofSecond == seen);
  }
}

TEST_CASE("A displacement moves the first image, not the second one", "[comparison]") {
  C3DE_GL_OR_SKIP(gl);
  const Block first(300, 60), second(160, 24);
  ImageRenderer &images = *gl.renderer->images();
  ImageDisplay look = lookAt(added(images.addImage(first.image())), added(images.addImage(second.image())));
  const GridGeometry grid{{2, 2, 2}, {200, 0, 0, 0, 0, 200, 0, 0, 0, 0, 200, 0, -100, -100, -100, 1}};
  std::vector<float> u;
  for (int i = 0; i < 8; ++i) u.insert(u.end(), {20.0f, 0.0f, 0.0f});
  look.displacement = added(images.addDisplacement(grid, u));
  look.comparison.weight = 0.5f;
  const Image image = slice(*gl.renderer, look, planeAt({0, 0, 0}));
  // x = -20: the first has moved away, the second is there. x = 20: both.
  CHECK_THAT(pixel(image, 32, 72)[0], WithinAbs(255.0 * 0.5 * 0.8, 1.5));
  CHECK_THAT(pixel(image, 112, 72)[0], WithinAbs(255.0 * 0.5 * (0.3 + 0.8), 1.5));
}
