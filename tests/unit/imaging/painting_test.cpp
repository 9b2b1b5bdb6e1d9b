// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/painting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "c3de/imaging/masks.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::imaging;

namespace {

Mask emptyMask(const std::array<std::size_t, 3> &size, const Vec3 &spacing, const Vec3 &origin = {}) {
  VolumeGeometry grid{
      size, {spacing[0], 0, 0, 0, 0, spacing[1], 0, 0, 0, 0, spacing[2], 0, origin[0], origin[1], origin[2], 1}};
  return {grid, std::vector<std::uint8_t>(grid.voxelCount())};
}

/// 60 x 60 x 60 voxels of 1 mm, turned by 30° about z.
Mask turnedMask() {
  Mask mask = emptyMask({60, 60, 60}, {1, 1, 1});
  const double c = std::cos(0.5236), s = std::sin(0.5236);
  mask.geometry.indexToWorld = {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 5, -10, 20, 1};
  return mask;
}

/// An image along the axes, of zeros.
Volume gridOf(const std::array<std::size_t, 3> &size, const Vec3 &spacing) {
  Volume volume;
  volume.geometry = emptyMask(size, spacing).geometry;
  volume.voxels = std::vector<std::int16_t>(volume.geometry.voxelCount(), 0);
  return volume;
}

BrushStroke strokeOf(std::vector<Vec3> path, double radius_mm) {
  BrushStroke stroke;
  stroke.path = std::move(path);
  stroke.radius_mm = radius_mm;
  return stroke;
}

/// The filled slices along k: voxels of each.
std::vector<std::size_t> areas(const Mask &mask) {
  const auto &n = mask.geometry.size;
  std::vector<std::size_t> counts(n[2], 0);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) counts[v / (n[0] * n[1])] += mask.voxels[v];
  return counts;
}

void paintDisc(Mask &mask, const Vec3 &centre, double radius_mm) {
  BrushStroke disc = strokeOf({centre}, radius_mm);
  disc.normal = Vec3{0, 0, 1};
  REQUIRE(paint(mask, disc, nullptr));
}

}  // namespace

TEST_CASE("A brush paints balls, tubes and discs of their exact size", "[painting]") {
  // Voxel counts differ from volumes by the voxels that the surface cuts, below 1 % at this radius.
  Mask ball = turnedMask();
  const Vec3 middle = ball.geometry.worldAt({30, 30, 30});
  REQUIRE(paint(ball, strokeOf({middle}, 20.0), nullptr));
  CHECK(volumeOf(ball) == Approx(4.0 / 3.0 * 3.14159265 * 8000.0).epsilon(0.01));
  // The same on voxels that are not cubes, partly outside of the grid.
  Mask flat = emptyMask({40, 80, 20}, {2, 1, 4});
  REQUIRE(paint(flat, strokeOf({flat.geometry.worldAt({0, 40, 10})}, 20.0), nullptr));
  CHECK(volumeOf(flat) == Approx(0.5 * 4.0 / 3.0 * 3.14159265 * 8000.0).epsilon(0.06));  // half a voxel layer of 2 mm
  // A path is joined: a tube with round ends.
  Mask tube = turnedMask();
  const Vec3 from = tube.geometry.worldAt({15, 30, 30}), to = tube.geometry.worldAt({45, 30, 30});
  REQUIRE(paint(tube, strokeOf({from, to}, 10.0), nullptr));
  CHECK(volumeOf(tube) == Approx(3.14159265 * 100.0 * (30.0 + 4.0 / 3.0 * 10.0)).epsilon(0.01));
  // A disc is one slice.
  Mask disc = turnedMask();
  paintDisc(disc, disc.geometry.worldAt({30, 30, 30}), 20.0);
  CHECK(volumeOf(disc) == Approx(3.14159265 * 400.0).epsilon(0.01));
  CHECK(areas(disc)[30] == voxelCount(disc));
  // Erasing.
  BrushStroke erased = strokeOf({middle}, 20.0);
  erased.isErasing = true;
  REQUIRE(paint(ball, erased, nullptr));
  CHECK(voxelCount(ball) == 0);
  // A brush smaller than a voxel, between centres, paints the voxel it is in.
  REQUIRE(paint(ball, strokeOf({ball.geometry.worldAt({7.4, 9.3, 11.4})}, 0.01), nullptr));
  CHECK(voxelCount(ball) == 1);
  CHECK(ball.voxels[7 + 60 * (9 + 60 * 11)] == 1);
}

TEST_CASE("A brush that is limited to values reads the image at each voxel", "[painting]") {
  Volume image = gridOf({8, 8, 8}, {2, 2, 2});
  auto &values = std::get<std::vector<std::int16_t>>(image.voxels);
  std::iota(values.begin(), values.end(), std::int16_t{0});
  Mask mask = emptyMask({16, 16, 16}, {1, 1, 1});  // finer than the image
  BrushStroke stroke = strokeOf({{7, 7, 7}}, 100.0);
  stroke.values = ValueLimits{64.0, 127.0};  // its second slice along k
  REQUIRE(paint(mask, stroke, &image));
  const std::vector<std::size_t> painted = areas(mask);
  CHECK(painted[1] == 225);  // 15 x 15: voxels beyond the border of the image have no value
  CHECK(painted[2] == 225);
  CHECK(voxelCount(mask) == 450);
  const auto without = paint(mask, stroke, nullptr);
  REQUIRE_FALSE(without);
  CHECK_THAT(without.error().message, Contains("needs an image"));
}

TEST_CASE("Strokes that mean nothing are refused", "[painting]") {
  Mask mask = emptyMask({4, 4, 4}, {1, 1, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(paint(mask, strokeOf({}, 1.0), nullptr).error().message, Contains("without points"));
  CHECK_THAT(paint(mask, strokeOf({{0, nan, 0}}, 1.0), nullptr).error().message, Contains("not finite"));
  for (const double radius : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    CHECK_THAT(paint(mask, strokeOf({{0, 0, 0}}, radius), nullptr).error().message, Contains("finite and > 0"));
  // Beyond the grid there is nothing to paint.
  REQUIRE(paint(mask, strokeOf({{100, 0, 0}, {1e300, 0, 0}}, 5.0), nullptr));
  CHECK(voxelCount(mask) == 0);
}

TEST_CASE("A region grows over connected voxels with similar values, up to a distance", "[painting]") {
  Volume image = gridOf({20, 20, 20}, {1, 1, 1});
  auto &values = std::get<std::vector<std::int16_t>>(image.voxels);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const std::size_t i = v % 20;
    values[v] = i < 8 ? 100 : i < 10 ? 300 : 110;  // two halves with a wall between them
  }
  const auto half = regionAround(image, {3, 10, 10}, 20.0, 0.0);
  REQUIRE(half);
  CHECK(voxelCount(*half) == 8 * 400);
  const auto all = regionAround(image, {3, 10, 10}, 200.0, 0.0);
  REQUIRE(all);
  CHECK(voxelCount(*all) == 8000);
  const auto near = regionAround(image, {3, 10, 10}, 200.0, 1.0);
  REQUIRE(near);
  CHECK(voxelCount(*near) == 7);
  CHECK_THAT(regionAround(image, {-30, 0, 0}, 1.0, 0.0).error().message, Contains("outside of the image"));
  CHECK_THAT(regionAround(image, {3, 3, 3}, -1.0, 0.0).error().message, Contains("a tolerance of -1"));
  CHECK_THAT(regionAround(image, {3, 3, 3}, 1.0, -2.0).error().message, Contains("a distance of -2"));
}

TEST_CASE("Slices between painted ones are filled by interpolated outlines", "[painting]") {
  // A cone: radii are interpolated linearly. The tolerance is half a pixel of 1 mm in the radius.
  Mask cone = emptyMask({64, 64, 21}, {1, 1, 3});
  const auto at = [&](double k) { return cone.geometry.worldAt({32, 32, k}); };
  paintDisc(cone, at(2), 8.0);
  paintDisc(cone, at(18), 24.0);
  CHECK(emptySlicesBetween(cone) == std::array<std::size_t, 3>{0, 0, 15});
  const auto filled = filledBetweenSlices(cone, 2);
  REQUIRE(filled);
  const std::vector<std::size_t> area = areas(*filled);
  for (std::size_t k = 2; k <= 18; ++k) {
    const double radius = std::sqrt(static_cast<double>(area[k]) / 3.14159265);
    CHECK(radius == Approx(8.0 + static_cast<double>(k - 2)).margin(0.5));
  }
  CHECK(area[1] + area[19] == 0);
  // Painted slices stay as they were.
  CHECK(area[2] == areas(cone)[2]);
  // Discs that do not overlap are moved onto each other: an oblique cylinder.
  Mask moved = emptyMask({64, 64, 11}, {1, 1, 1});
  paintDisc(moved, {12, 20, 0}, 8.0);
  paintDisc(moved, {52, 40, 10}, 8.0);
  const auto oblique = filledBetweenSlices(moved, 2);
  REQUIRE(oblique);
  for (std::size_t k = 0; k <= 10; ++k) {
    Vec3 sum{};
    double count = 0.0;
    for (std::size_t j = 0; j < 64; ++j)
      for (std::size_t i = 0; i < 64; ++i)
        if (oblique->voxels[i + 64 * (j + 64 * k)] != 0) {
          sum = sum + Vec3{double(i), double(j), 0.0};
          count += 1.0;
        }
    CHECK(count == Approx(3.14159265 * 64.0).epsilon(0.06));  // half a pixel of the radius
    CHECK(norm((1.0 / count) * sum - Vec3{12.0 + 4.0 * double(k), 20.0 + 2.0 * double(k), 0.0}) < 0.5);
  }
  // Along another axis, and where there is nothing to fill.
  const auto none = filledBetweenSlices(cone, 0);
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("no empty slice between two painted ones"));
  CHECK(axisAlong(turnedMask().geometry, {0, 0, -1}) == 2);
  CHECK(axisAlong(turnedMask().geometry, {0.8, 0.5, 0}) == 0);
}

TEST_CASE("A mask becomes a label of a map, in place of the label it came from", "[painting]") {
  LabelMap map{emptyMask({4, 1, 1}, {1, 1, 1}).geometry, {1, 1, 2, 0}, {{1, "a", {}}, {2, "b", {}}}};
  Mask mask{map.geometry, {0, 1, 1, 1}};
  const auto same = withLabel(&map, mask, {1, "a new", {}});
  REQUIRE(same);
  CHECK(same->voxels == std::vector<std::uint16_t>{0, 1, 1, 1});
  REQUIRE(same->labels.size() == 1);  // nothing of b is left
  CHECK(same->labels[0].name == "a new");
  const auto added = withLabel(&map, mask, {0, "c", {}});
  REQUIRE(added);
  CHECK(added->voxels == std::vector<std::uint16_t>{1, 3, 3, 3});
  REQUIRE(added->labels.size() == 2);
  CHECK(added->labels[1].value == 3);
  const auto alone = withLabel(nullptr, mask, {0, "c", {}});
  REQUIRE(alone);
  CHECK(alone->voxels == std::vector<std::uint16_t>{0, 1, 1, 1});
  Mask other = emptyMask({5, 1, 1}, {1, 1, 1});
  CHECK_THAT(withLabel(&map, other, {1, "a", {}}).error().message, Contains("different grids"));
  CHECK(voxelCount(onGrid(mask, emptyMask({8, 1, 1}, {0.5, 1, 1}).geometry)) == 6);
}
