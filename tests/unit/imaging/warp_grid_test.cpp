// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/warp_grid.h"

#include <cmath>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::imaging;

namespace {

constexpr double kSpacing = 5.0, kRim = 8.0;

WorldBox box(const Vec3 &low, const Vec3 &high) { return {low, high}; }

WorldBox moved(const WorldBox &b, const Vec3 &by) { return {b.low + by, b.high + by}; }

/// From the first to the last point of the grid.
WorldBox reachOf(const VolumeGeometry &g) {
  WorldBox reach;
  reach.add(g.worldAt({}));
  reach.add(g.worldAt(
      {static_cast<double>(g.size[0] - 1), static_cast<double>(g.size[1] - 1), static_cast<double>(g.size[2] - 1)}));
  return reach;
}

const WorldBox kOrgan = box({-30, 10, -100}, {70, 90, -40});

}  // namespace

TEST_CASE("a grid stays while the bodies are in it and is laid anew when they or their rim leave it", "[warp-grid]") {
  FollowingGrid grid;
  CHECK(grid.follow(kOrgan, kSpacing, kRim));
  const VolumeGeometry first = grid.geometry();
  CHECK(reachOf(first).holds(kOrgan.grown(kRim + kSpacing)));
  CHECK(first.spacing()[0] == Approx(0.5 * kSpacing));
  // The margin is 15 % of the size: 15 mm along x.
  CHECK_FALSE(grid.follow(moved(kOrgan, {14.9, 0, 0}), kSpacing, kRim));
  CHECK_FALSE(grid.follow(moved(kOrgan, {-14.9, 0, 0}), kSpacing, kRim));
  CHECK(sameGrid(grid.geometry(), first, 0.0));
  CHECK(grid.follow(moved(kOrgan, {15.1, 0, 0}), kSpacing, kRim));
  CHECK(reachOf(grid.geometry()).holds(moved(kOrgan, {15.1, 0, 0}).grown(kRim + kSpacing)));
  CHECK_FALSE(grid.follow(moved(kOrgan, {15.1, 0, 0}), kSpacing, kRim));
  CHECK(grid.follow(moved(kOrgan, {15.1, 0, 0}), kSpacing, kRim + 1.0));
}

TEST_CASE("a grid that follows a long way is laid rarely and always holds the bodies", "[warp-grid]") {
  FollowingGrid grid;
  std::size_t laid = 0;
  for (int i = 0; i <= 3000; ++i) {
    const WorldBox now = moved(kOrgan, {0.1 * i, 0.05 * i, -0.2 * i});
    laid += grid.follow(now, kSpacing, kRim) ? 1 : 0;
    REQUIRE(reachOf(grid.geometry()).holds(now.grown(kRim + kSpacing)));
    REQUIRE(grid.geometry().spacing()[2] == Approx(0.5 * kSpacing));
  }
  // 600 mm along the shortest side, whose margin is 9 mm.
  CHECK(laid > 10);
  CHECK(laid < 80);
}

TEST_CASE("a grid around bodies far apart keeps its number of points and becomes coarser, then fine again",
          "[warp-grid]") {
  const WarpGridLimits limits;
  FollowingGrid grid;
  grid.follow(kOrgan, kSpacing, kRim);
  for (const double apart : {100.0, 300.0, 600.0, 2000.0, 1e6}) {
    WorldBox both = kOrgan;
    both.add({kOrgan.high[0] + apart, kOrgan.low[1], kOrgan.low[2]});
    grid.follow(both, kSpacing, kRim);
    CAPTURE(apart);
    for (std::size_t a = 0; a < 3; ++a) CHECK(grid.geometry().size[a] <= limits.mostPoints);
    CHECK(grid.geometry().spacing()[0] <= limits.coarsestStep * kSpacing * (1.0 + 1e-12));
    // The region beyond the limit is excluded, never the initial position of the bodies.
    CHECK(reachOf(grid.geometry()).holds(kOrgan));
    if (apart <= 600.0) CHECK(reachOf(grid.geometry()).holds(both.grown(kRim + kSpacing)));
    CHECK_FALSE(grid.follow(both, kSpacing, kRim));
  }
  CHECK(grid.follow(kOrgan, kSpacing, kRim));
  CHECK(grid.geometry().spacing()[0] == Approx(0.5 * kSpacing));
}

TEST_CASE("without bodies there is no grid, and points that are no numbers do not stretch it", "[warp-grid]") {
  FollowingGrid grid;
  CHECK_FALSE(grid.follow({}, kSpacing, kRim));
  CHECK(grid.geometry().voxelCount() == 0);
  WorldBox odd = kOrgan;
  odd.add({NAN, 0, 0});
  odd.add({0, INFINITY, 0});
  CHECK(odd.holds(kOrgan));
  CHECK(kOrgan.holds(odd));
  CHECK(grid.follow(odd, kSpacing, kRim));
  CHECK(grid.follow({}, kSpacing, kRim));
  CHECK(grid.geometry().voxelCount() == 0);
}
