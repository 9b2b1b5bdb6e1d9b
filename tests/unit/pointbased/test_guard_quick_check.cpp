// SPDX-License-Identifier: Apache-2.0
// The quick check of the guard at every step, against the plain loops it replaces.
#include <cmath>
#include <limits>

#include "shapes.h"
#include "stepping/monitoring/guard.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

Body bodyOf(std::size_t phyxels) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < phyxels; ++i)
    points.push_back(0.01 * Vec3(static_cast<double>(i % 3), static_cast<double>(i / 3), 0));
  return Body("body", shapes::restState(points, 0.01), Constitution{{Material()}, kCloudStabilisation}, serialFor());
}

}  // namespace

TEST_CASE("the guard's glance finds a number that is none at every place, whatever the count") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  // All remainders of the vector lengths in which it reads the numbers.
  for (std::size_t phyxels = 1; phyxels <= 9; ++phyxels) {
    Body body = bodyOf(phyxels);
    State &state = body.state();
    CHECK(quickCheck(body).finite);
    for (std::size_t i = 0; i < phyxels; ++i)
      for (int k = 0; k < 3; ++k)
        for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300, -1e300}) {
          CAPTURE(phyxels, i, k, bad);
          state.displacements[i][k] = bad;
          CHECK_FALSE(quickCheck(body).finite);
          CHECK_FALSE(isFinite(state.displacements));
          state.displacements[i][k] = 0.0;
          state.velocities[i][k] = bad;
          CHECK_FALSE(quickCheck(body).finite);
          CHECK_FALSE(isFinite(state.velocities));
          state.velocities[i][k] = 0.0;
        }
  }
}

TEST_CASE("what the guard's glance refuses is found at its phyxel, also where the squares of one are still numbers") {
  Body body = bodyOf(9);
  State &state = body.state();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1e300, 1e152}) {
    CAPTURE(bad);
    state.velocities[5][1] = bad;
    REQUIRE_FALSE(quickCheck(body).finite);
    CHECK(firstNonFinite(body).phyxel == 5);
    CHECK(firstNonFinite(body).quantity == "the velocity is not finite");
    state.velocities[5].setZero();
  }
  // Their sum is not a number.
  for (const std::size_t i : {3, 4, 5}) state.displacements[i] = Vec3(1.3e154, 0, 0);
  REQUIRE_FALSE(quickCheck(body).finite);
  CHECK(firstNonFinite(body).phyxel == 3);
  CHECK(firstNonFinite(body).quantity == "the displacement is not finite");
}

TEST_CASE("no phyxel is faster relative to its body than the guard's bound, which is at most four times too large") {
  shapes::Random random(7);
  for (const std::size_t phyxels : {1, 2, 3, 4, 5, 8, 27, 30}) {
    Body body = bodyOf(phyxels);
    const Vec3 all = 100.0 * random.vector();
    for (Vec3 &v : body.state().velocities) v = all + random.vector();
    const double fastest = fullCheck(body).fastest, bound = quickCheck(body).speedBound;
    CAPTURE(phyxels, fastest, bound);
    CHECK(bound >= fastest);
    // The diagonal of the box around all velocities is at most 2√3 times the farthest from any point within it.
    CHECK(bound <= 2.0 * std::sqrt(3.0) * fastest + 1e-12);
  }
}
