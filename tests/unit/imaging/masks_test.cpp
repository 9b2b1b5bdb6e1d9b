// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/masks.h"
#include "c3de/imaging/mask_coverage.h"

#include <limits>

#include "c3de/imaging/surface.h"
#include "phantoms.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::imaging;
using phantoms::Dice;
using phantoms::get;

namespace {

template <class T>
T value(Expected<T> expected) {
  if (!expected) throw std::runtime_error(expected.error().message);
  return std::move(*expected);
}

// The definition, voxel by voxel: within the radius of a set voxel.
Mask grownByDefinition(const Mask &mask, double radius) {
  Mask out = mask;
  const auto &n = mask.geometry.size;
  std::vector<Vec3> set;
  const auto world = [&](std::size_t v) {
    return mask.geometry.worldAt(
        {static_cast<double>(v % n[0]), static_cast<double>(v / n[0] % n[1]), static_cast<double>(v / (n[0] * n[1]))});
  };
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v] != 0) set.push_back(world(v));
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    for (const Vec3 &x : set)
      if (norm(world(v) - x) <= radius + 1e-9) out.voxels[v] = 1;
  return out;
}
Mask inverted(Mask mask) {
  for (auto &v : mask.voxels) v = v != 0 ? 0 : 1;
  return mask;
}

VolumeGeometry sheared() {
  VolumeGeometry g = phantoms::oblique({17, 16, 15}, {1.0, 1.2, 2.0});
  for (std::size_t r = 0; r < 3; ++r) g.indexToWorld[8 + r] += 0.25 * g.indexToWorld[4 + r];
  return g;
}

// A shape with gaps, spurs and bays, away from the border by `margin`.
Mask ragged(const VolumeGeometry &g, std::size_t margin) {
  Mask mask{g, std::vector<std::uint8_t>(g.voxelCount(), 0)};
  Dice dice(7);
  for (std::size_t k = margin; k + margin < g.size[2]; ++k)
    for (std::size_t j = margin; j + margin < g.size[1]; ++j)
      for (std::size_t i = margin; i + margin < g.size[0]; ++i) phantoms::set(mask, {i, j, k}, dice(100) < 30);
  return mask;
}

}  // namespace

TEST_CASE("a threshold takes rescaled values, both limits included", "[imaging][masks]") {
  Volume volume;
  volume.geometry = phantoms::grid({5, 1, 1});
  volume.voxels = std::vector<std::int16_t>{0, 1, 2, 3, 4};
  volume.slope = 2.0;
  volume.intercept = -10.0;
  CHECK(value(threshold(volume, -8.0, -4.0)).voxels == std::vector<std::uint8_t>{0, 1, 1, 1, 0});
  volume.voxels = std::vector<float>{-1.0f, std::numeric_limits<float>::quiet_NaN(), 0.5f, 1.0f, 2.0f};
  volume.slope = 1.0;
  volume.intercept = 0.0;
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(value(threshold(volume, 0.5, infinity)).voxels == std::vector<std::uint8_t>{0, 0, 1, 1, 1});
  CHECK_THAT(threshold(volume, 2.0, 1.0).error().message, Contains("from 2 to 1"));
  CHECK_FALSE(threshold(volume, std::nan(""), 1.0));
}

TEST_CASE("labels become masks on their own grid", "[imaging][masks]") {
  LabelMap map;
  map.geometry = phantoms::oblique({3, 2, 1}, {1.0, 2.0, 3.0});
  map.voxels = {0, 7, 7, 3, 500, 0};
  CHECK(maskOf(map, 7).voxels == std::vector<std::uint8_t>{0, 1, 1, 0, 0, 0});
  CHECK(sameGrid(maskOf(map, 7).geometry, map.geometry));
  CHECK_THAT(volumeOf(maskOf(map, 7)), WithinRel(12.0, 1e-12));
  CHECK(maskOf(map, std::vector<std::uint16_t>{3, 500}).voxels == std::vector<std::uint8_t>{0, 0, 0, 1, 1, 0});
  CHECK(voxelCount(maskOf(map, 9)) == 0);
}

TEST_CASE("blocks of voxels are filled in part and keep volume and centre", "[imaging][masks]") {
  const Mask mask = phantoms::ball(phantoms::oblique({41, 35, 23}, {0.7, 0.9, 2.0}, true), 11.0);
  Vec3 centre{};
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    const auto &n = mask.geometry.size;
    if (mask.voxels[v] != 0)
      centre = centre + mask.geometry.worldAt({static_cast<double>(v % n[0]), static_cast<double>(v / n[0] % n[1]),
                                               static_cast<double>(v / (n[0] * n[1]))});
  }
  centre = (1.0 / static_cast<double>(voxelCount(mask))) * centre;
  for (const double edge : {0.0, 1.5, 2.8, 4.1}) {
    INFO("blocks of " << edge << " mm");
    const Fill fill = value(fillOf(mask, edge));
    const auto &n = fill.geometry.size;
    REQUIRE(fill.values.size() == fill.geometry.voxelCount());
    double sum = 0.0;
    Vec3 middle{};
    for (std::size_t v = 0; v < fill.values.size(); ++v) {
      const double part = static_cast<double>(fill.values[v]);
      CHECK((part >= 0.0 && part <= 1.0));
      sum += part;
      middle =
          middle + part * fill.geometry.worldAt({static_cast<double>(v % n[0]), static_cast<double>(v / n[0] % n[1]),
                                                 static_cast<double>(v / (n[0] * n[1]))});
    }
    // Single precision.
    CHECK_THAT(sum * fill.geometry.voxelVolume(), WithinRel(volumeOf(mask), 1e-6));
    // A block represents its contents at its own centre: off by parts of its edge at the border, to all sides alike.
    CHECK(norm((1.0 / sum) * middle - centre) < 0.005 * edge + 1e-4);
    for (std::size_t a = 0; a < 3; ++a)
      CHECK(fill.geometry.spacing()[a] <= std::max(edge, mask.geometry.spacing()[a]) + 1e-9);
  }
  CHECK_FALSE(fillOf(Mask{phantoms::grid({2, 2, 2}), std::vector<std::uint8_t>(8, 0)}));
  CHECK_FALSE(fillOf(mask, -1.0));
}

TEST_CASE("components hang together through faces", "[imaging][masks]") {
  Mask mask = phantoms::box(phantoms::grid({12, 12, 12}), {1, 1, 1}, {5, 5, 5});
  phantoms::set(mask, {5, 5, 5});  // a corner
  phantoms::set(mask, {5, 5, 6});
  phantoms::set(mask, {0, 4, 4});  // a face
  // A winding path: up, over and down again, so that runs are joined late.
  for (std::size_t k = 1; k < 11; ++k) phantoms::set(mask, {8, 8, k}), phantoms::set(mask, {10, 8, k});
  phantoms::set(mask, {9, 8, 10});
  CHECK(value(componentSizes(mask)) == std::vector<std::size_t>{65, 21, 2});
  CHECK(voxelCount(value(connectedComponent(mask, {10, 8, 1}))) == 21);
  CHECK(get(value(connectedComponent(mask, {10, 8, 1})), {8, 8, 1}));
  CHECK(voxelCount(value(connectedComponent(mask, {5, 5, 6}))) == 2);
  const Mask largest = value(largestComponent(mask));
  CHECK(voxelCount(largest) == 65);
  CHECK(get(largest, {0, 4, 4}));
  CHECK_THAT(connectedComponent(mask, {11, 11, 11}).error().message, Contains("(11, 11, 11) is not in the mask"));
  CHECK_THAT(connectedComponent(mask, {12, 0, 0}).error().message, Contains("outside of the grid of 12 x 12 x 12"));
  const Mask empty{phantoms::grid({3, 3, 3}), std::vector<std::uint8_t>(27, 0)};
  CHECK(voxelCount(value(largestComponent(empty))) == 0);
}

TEST_CASE("holes are filled, bays and tunnels are not", "[imaging][masks]") {
  Mask mask = phantoms::box(phantoms::grid({12, 12, 12}), {1, 1, 1}, {11, 11, 11});
  phantoms::set(mask, {5, 5, 5}, false);
  phantoms::set(mask, {5, 6, 6}, false);                                       // touches it along an edge
  for (std::size_t i = 1; i < 11; ++i) phantoms::set(mask, {i, 3, 3}, false);  // tunnel
  for (std::size_t k = 8; k < 11; ++k) phantoms::set(mask, {8, 8, k}, false);  // bay
  const Mask filled = value(fillHoles(mask));
  CHECK(voxelCount(filled) == 1000 - 10 - 3);
  CHECK(get(filled, {5, 5, 5}));
  CHECK(get(filled, {5, 6, 6}));
  CHECK_FALSE(get(filled, {5, 3, 3}));
  CHECK_FALSE(get(filled, {8, 8, 8}));
  // A hole that the border of the grid opens.
  Mask cut = phantoms::box(phantoms::grid({6, 6, 6}), {0, 0, 0}, {6, 6, 6});
  phantoms::set(cut, {0, 3, 3}, false);
  CHECK(voxelCount(value(fillHoles(cut))) == 215);
}

TEST_CASE("mending opens, closes, keeps the largest part and fills holes, in this order", "[imaging][masks]") {
  const VolumeGeometry grid = phantoms::grid({20, 12, 12});
  Mask mask = phantoms::box(grid, {1, 1, 1}, {9, 9, 9});
  phantoms::set(mask, {5, 5, 5}, false);
  const Mask other = phantoms::box(grid, {12, 2, 2}, {17, 7, 7});
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] |= other.voxels[v];
  for (std::size_t i = 9; i < 12; ++i) phantoms::set(mask, {i, 4, 4}, true);  // a bridge, which opening removes
  CHECK(value(mended(mask, {})).voxels == mask.voxels);
  const Mask all = value(mended(mask, {1.0, 1.0, true, true}));
  CHECK(all.voxels == value(fillHoles(value(largestComponent(value(closed(value(opened(mask, 1.0)), 1.0)))))).voxels);
  CHECK(get(all, {2, 2, 2}));
  CHECK_FALSE(get(all, {10, 4, 4}));
  CHECK_FALSE(get(all, {14, 4, 4}));
  CHECK_THAT(mended(mask, {0.0, 1e9, false, false}).error().message, Contains("radius"));
}

TEST_CASE("closing and opening are what their definition says, on any grid", "[imaging][masks]") {
  for (const VolumeGeometry &g :
       {phantoms::grid({17, 16, 15}), phantoms::oblique({17, 16, 15}, {0.7, 1.3, 2.1}, true), sheared()})
    for (const double radius : {1.0, 2.1, 3.4}) {
      INFO("radius " << radius << ", shear " << g.shear());
      // Far enough from the border that the definition does not need the region beyond.
      const Mask mask = ragged(g, 5);
      const Mask shut = inverted(grownByDefinition(inverted(grownByDefinition(mask, radius)), radius));
      CHECK(value(closed(mask, radius)).voxels == shut.voxels);
      const Mask thick = grownByDefinition(mask, 1.5 * radius);
      const Mask open = grownByDefinition(inverted(grownByDefinition(inverted(thick), radius)), radius);
      // Dilation of the eroded mask adds no voxel that was not there before.
      CHECK(value(opened(thick, radius)).voxels == open.voxels);
    }
}

TEST_CASE("the border of the grid neither stops a closing nor is worn off by an opening", "[imaging][masks]") {
  const VolumeGeometry g = phantoms::grid({20, 20, 20});
  Mask half = phantoms::box(g, {0, 0, 0}, {20, 20, 10});
  CHECK(value(opened(half, 4.0)).voxels == half.voxels);
  CHECK(value(closed(half, 4.0)).voxels == half.voxels);
  phantoms::set(half, {0, 10, 5}, false);
  CHECK(voxelCount(value(closed(half, 1.5))) == 4000);
  CHECK_THAT(closed(half, 0.0).error().message, Contains("radius of 0 mm"));
  CHECK_THAT(opened(half, 1e4).error().message, Contains("at most 128"));
  CHECK(value(closed(Mask{g, std::vector<std::uint8_t>(8000, 0)}, 3.0)).voxels == std::vector<std::uint8_t>(8000, 0));
}

TEST_CASE("work on masks can be stopped", "[imaging][masks]") {
  const Mask mask = phantoms::ball(phantoms::grid({30, 30, 30}), 10.0);
  const auto never = [](double, const std::string &) { return false; };
  for (const auto &result : {connectedComponent(mask, {15, 15, 15}, never), largestComponent(mask, never),
                             fillHoles(mask, never), closed(mask, 3.0, never), opened(mask, 3.0, never)}) {
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::cancelled);
  }
}

TEST_CASE("labels keep their place on another grid", "[imaging][masks]") {
  LabelMap map;
  map.geometry = phantoms::oblique({20, 20, 20}, {1.0, 1.0, 1.0});
  map.voxels.assign(8000, 0);
  map.labels = {{3, "liver", {}}, {9, "nothing", {}}};
  const Mask ball = phantoms::ball(map.geometry, 8.0);
  for (std::size_t v = 0; v < 8000; ++v) map.voxels[v] = ball.voxels[v] != 0 ? 3 : 0;
  // Twice as fine, left-handed, larger than the map.
  VolumeGeometry fine = phantoms::grid({60, 60, 60}, {0.5, 0.5, -0.5});
  const Vec3 shift = phantoms::centreOf(map.geometry) - phantoms::centreOf(fine);
  for (std::size_t c = 0; c < 3; ++c) fine.indexToWorld[12 + c] += shift[c];
  const LabelMap out = value(resampled(map, fine));
  REQUIRE(out.labels.size() == 1);
  CHECK(out.labels[0].name == "liver");
  // Nearest neighbours preserve a volume up to half a voxel at the surface, averaged.
  CHECK_THAT(volumeOf(maskOf(out, 3)), WithinRel(volumeOf(maskOf(map, 3)), 0.01));
  CHECK(sameGrid(out.geometry, fine));
  const LabelMap same = value(resampled(map, map.geometry));
  CHECK(same.voxels == map.voxels);
  CHECK_FALSE(resampled(map, VolumeGeometry{}));
}

TEST_CASE("voxels within a closed surface are those whose centre is inside", "[imaging][masks]") {
  // A surface of a mask is converted back to the mask, on oblique and sheared grids, and on a finer one with its
  // volume.
  const VolumeGeometry g = phantoms::oblique({40, 36, 30}, {1.2, 1.5, 2.0});
  Mask ball{g, std::vector<std::uint8_t>(g.voxelCount(), 0)};
  const Vec3 centre = phantoms::centreOf(g);
  for (std::size_t v = 0; v < g.voxelCount(); ++v) {
    const Vec3 x = g.worldAt({double(v % 40), double(v / 40 % 36), double(v / 1440)});
    ball.voxels[v] = norm(x - centre) < 17.0 ? 1 : 0;
  }
  SurfaceSettings settings;
  settings.edgeLength = 2.0;
  const auto surface = surfaceOf(ball, settings);
  REQUIRE(surface);
  const Mask again = maskOf(*surface, g);
  std::size_t wrong = 0;
  for (std::size_t v = 0; v < g.voxelCount(); ++v) wrong += again.voxels[v] != ball.voxels[v] ? 1 : 0;
  // Smoothing moves the surface by parts of a voxel: some of those at the border (about 4 in 10 of all) change sides.
  CHECK(wrong < voxelCount(ball) / 20);
  CHECK(volumeOf(again) == Approx(geometry::signedVolume(*surface)).epsilon(0.01));
  // Rays through vertices and edges: an octahedron with whole indices, either orientation.
  geometry::TriangleMesh octahedron;
  const VolumeGeometry whole{{21, 21, 21}, kIdentity4};
  octahedron.vertices = {{2, 10, 10}, {18, 10, 10}, {10, 2, 10}, {10, 18, 10}, {10, 10, 2}, {10, 10, 18}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const bool isReversed = GENERATE(false, true);
  if (isReversed)
    for (Triangle &t : octahedron.triangles) std::swap(t[1], t[2]);
  const Mask inside = maskOf(octahedron, whole);
  for (std::size_t v = 0; v < whole.voxelCount(); ++v) {
    const double away =
        std::abs(double(v % 21) - 10) + std::abs(double(v / 21 % 21) - 10) + std::abs(double(v / 441) - 10);
    if (away < 8.0) REQUIRE(inside.voxels[v] == 1);
    if (away > 8.0) REQUIRE(inside.voxels[v] == 0);
  }
}

TEST_CASE("specks are components of few voxels beside a large one", "[imaging][masks]") {
  Mask mask = phantoms::ball(phantoms::grid({60, 60, 60}), 20.0);
  const std::size_t whole = voxelCount(mask);
  phantoms::set(mask, {1, 1, 1});
  phantoms::set(mask, {56, 56, 55});
  phantoms::set(mask, {56, 56, 56});
  const auto found = removeSpecks(mask);
  REQUIRE(found);
  CHECK(found->specks == 2);
  CHECK(found->voxels == 3);
  CHECK(voxelCount(found->mask) == whole);
  // Islands as large as everything else are not specks.
  Mask few = phantoms::box(phantoms::grid({20, 20, 20}), {2, 2, 2}, {4, 4, 4});
  phantoms::set(few, {10, 10, 10});
  CHECK(removeSpecks(few)->specks == 0);
}

TEST_CASE("what a surface leaves outside is told by voxels", "[imaging][masks]") {
  const VolumeGeometry g = phantoms::oblique({80, 50, 50}, {1.0, 1.0, 1.5}, true);
  const Mask ball = phantoms::where(g, [](const Vec3 &x) { return norm(x - Vec3{-8.0, 0.0, 0.0}) < 14.0; });
  const auto skin = surfaceOf(ball);
  REQUIRE(skin);
  CHECK(voxelCount(notEnclosed(ball, *skin)) == 0);
  Mask two = ball;
  const Mask other = phantoms::where(g, [](const Vec3 &x) { return norm(x - Vec3{20.0, 5.0, 0.0}) < 6.0; });
  for (std::size_t v = 0; v < two.voxels.size(); ++v) two.voxels[v] |= other.voxels[v];
  CHECK(notEnclosed(two, *skin).voxels == other.voxels);
}
