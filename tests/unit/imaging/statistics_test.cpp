// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "c3de/imaging/displacement.h"
#include "c3de/imaging/statistics.h"
#include "support/catch.h"

using namespace c3de;
using imaging::Volume;

namespace {

template <class T>
Volume volumeOf(std::vector<T> voxels) {
  Volume volume;
  volume.geometry.size = {voxels.size(), 1, 1};
  volume.voxels = std::move(voxels);
  return volume;
}

}  // namespace

TEST_CASE("the robust range leaves out the share that was asked for, in values of the image", "[imaging]") {
  std::vector<std::int16_t> voxels;
  for (int i = 0; i < 10000; ++i) voxels.push_back(static_cast<std::int16_t>(i / 10));
  voxels[3] = -2000;
  voxels[7] = 30000;
  Volume volume = volumeOf(voxels);
  volume.slope = 2.0;
  volume.intercept = -1000.0;
  const auto range = imaging::robustRange(volume, 0.01);
  CHECK(range.min == -5000.0);
  CHECK(range.max == 59000.0);
  CHECK_THAT(range.low, WithinAbs(2.0 * 10 - 1000.0, 2.0));
  CHECK_THAT(range.high, WithinAbs(2.0 * 989 - 1000.0, 2.0));
  volume.slope = -2.0;
  const auto turned = imaging::robustRange(volume, 0.01);
  CHECK(turned.min == -61000.0);
  CHECK(turned.low < turned.high);
}

TEST_CASE("numbers that are not finite do not count, and a single value has a range as well", "[imaging]") {
  std::vector<float> voxels(1000, 0.25f);
  voxels[1] = std::numeric_limits<float>::quiet_NaN();
  voxels[2] = std::numeric_limits<float>::infinity();
  const auto flat = imaging::robustRange(volumeOf(voxels));
  CHECK(flat.min == 0.25);
  CHECK(flat.max == 0.25);
  CHECK(flat.low < flat.high);
  for (std::size_t i = 500; i < 1000; ++i) voxels[i] = 8.25f;
  const auto two = imaging::robustRange(volumeOf(voxels));
  CHECK_THAT(two.low, WithinAbs(0.25, 8.0 / 4096));
  CHECK_THAT(two.high, WithinAbs(8.25, 8.0 / 4096));
}

TEST_CASE("a displacement grid is linear inside and zero outside", "[imaging]") {
  imaging::DisplacementGrid grid;
  grid.geometry.size = {3, 4, 2};
  grid.geometry.indexToWorld = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 5, 0, -1, -2, -3, 1};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 x = grid.geometry.worldAt({double(i), double(j), double(k)});
        for (const double u : {0.5 * x[0], x[1] - x[2], 7.0}) grid.xyz_mm.push_back(static_cast<float>(u));
      }
  const Vec3 u = grid.at({0.4, 1.5, -0.25});
  CHECK_THAT(u[0], WithinAbs(0.2, 1e-6));
  CHECK_THAT(u[1], WithinAbs(1.75, 1e-6));
  CHECK_THAT(u[2], WithinAbs(7.0, 1e-6));
  CHECK(grid.at({3.0, 7.0, 2.0})[2] == 7.0);  // the last point
  CHECK(grid.at({3.01, 7.0, 2.0}) == Vec3{});
  CHECK(grid.at({-1.01, 0.0, 0.0}) == Vec3{});
}
