// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "pointbased/region.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Distance to the border of a box from points spread over its six faces.
double sampledDistance(const BoxRegion &box, const Vec3 &x, int n) {
  double nearest = kInfinity;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          Vec3 t;
          t[axis] = side;
          t[(axis + 1) % 3] = static_cast<double>(i) / n;
          t[(axis + 2) % 3] = static_cast<double>(j) / n;
          const Vec3 p = box.min + t.cwiseProduct(box.max - box.min);
          nearest = std::min(nearest, (p - x).norm());
        }
  return nearest;
}

}  // namespace

TEST_CASE("The signed distance of a box is that of its nearest border point, inside and outside", "[region]") {
  const BoxRegion box{Vec3(-0.1, 0.0, 0.2), Vec3(0.3, 0.1, 0.5)};
  shapes::Random random(3);
  constexpr int n = 100;
  // Faces are sampled every 4 mm or finer, so the nearest sample is at most 2.9 mm from the nearest point.
  constexpr double side = 0.0029;
  for (int k = 0; k < 60; ++k) {
    const Vec3 x = Vec3(0.1, 0.05, 0.35) + 0.4 * random.vector();
    const double exact = signedDistance(box, x);
    const double sampled = sampledDistance(box, x, n);
    const bool inside = (x.array() >= box.min.array()).all() && (x.array() <= box.max.array()).all();
    CAPTURE(x.transpose(), exact, sampled);
    CHECK((exact <= 0.0) == inside);
    CHECK(std::abs(exact) <= sampled + 1e-12);
    CHECK(sampled <= std::hypot(std::abs(exact), side) + 1e-12);
  }
}

TEST_CASE("The signed distance of a sphere and a half-space is exact for any length of the normal", "[region]") {
  const SphereRegion sphere{Vec3(0.1, 0.2, 0.3), 0.05};
  CHECK(signedDistance(sphere, Vec3(0.1, 0.2, 0.3)) == Approx(-0.05).epsilon(1e-14));
  CHECK(signedDistance(sphere, Vec3(0.1, 0.2, 0.5)) == Approx(0.15).epsilon(1e-14));
  for (const double length : {1e-3, 1.0, 250.0}) {
    const HalfSpaceRegion half{Vec3(0.1, 0, 0), length * Vec3(0.6, 0.8, 0.0)};
    CHECK(signedDistance(half, Vec3(0.1, 0, 7)) == 0.0);
    CHECK(signedDistance(half, Vec3(0.1, 0, 7) + 0.3 * Vec3(0.6, 0.8, 0.0)) == Approx(0.3).epsilon(1e-13));
    CHECK(signedDistance(half, Vec3(0.1, 0, 7) - 0.3 * Vec3(0.6, 0.8, 0.0)) == Approx(-0.3).epsilon(1e-13));
  }
  CHECK(signedDistance(EverywhereRegion{}, Vec3(1e9, 0, 0)) == -kInfinity);
}

TEST_CASE("The border belongs to a region, the next number outside does not", "[region]") {
  const double outside = std::nextafter(0.3, 1.0);
  CHECK(contains(BoxRegion{Vec3(0.1, 0, 0), Vec3(0.3, 1, 1)}, Vec3(0.3, 1.0, 0.0)));
  CHECK_FALSE(contains(BoxRegion{Vec3(0.1, 0, 0), Vec3(0.3, 1, 1)}, Vec3(outside, 1.0, 0.0)));
  CHECK(contains(SphereRegion{Vec3::Zero(), 0.3}, Vec3(0, 0.3, 0)));
  CHECK_FALSE(contains(SphereRegion{Vec3::Zero(), 0.3}, Vec3(0, outside, 0)));
  CHECK(contains(HalfSpaceRegion{Vec3(0.3, 0, 0), Vec3(3, 0, 0)}, Vec3(0.3, 5, 5)));
  CHECK_FALSE(contains(HalfSpaceRegion{Vec3(0.3, 0, 0), Vec3(3, 0, 0)}, Vec3(outside, 5, 5)));
  CHECK(contains(BoxRegion{Vec3(0, 0, 0.2), Vec3(1, 1, 0.2)}, Vec3(0.5, 0.5, 0.2)));
}

TEST_CASE("The normal of the border is the gradient of the signed distance", "[region]") {
  const Region regions[] = {BoxRegion{Vec3(-0.1, 0.0, 0.2), Vec3(0.3, 0.1, 0.5)},
                            SphereRegion{Vec3(0.1, 0.05, 0.3), 0.1},
                            HalfSpaceRegion{Vec3(0.1, 0.05, 0.3), Vec3(1, -2, 0.5)}};
  shapes::Random random(5);
  constexpr double h = 1e-7;
  for (const Region &region : regions)
    for (int k = 0; k < 40; ++k) {
      const Vec3 x = Vec3(0.1, 0.05, 0.35) + 0.3 * random.vector();
      Vec3 gradient;
      for (int a = 0; a < 3; ++a)
        gradient[a] =
            (signedDistance(region, x + h * Vec3::Unit(a)) - signedDistance(region, x - h * Vec3::Unit(a))) / (2 * h);
      CAPTURE(region.index(), x.transpose(), gradient.transpose());
      // Central differences: curvature of the sphere and rounding, both below 1e-6 at this step.
      CHECK((borderNormal(region, x) - gradient).norm() < 1e-6);
    }
  CHECK(borderNormal(EverywhereRegion{}, Vec3(1, 2, 3)) == Vec3::Zero());
  CHECK(borderNormal(SphereRegion{Vec3::Zero(), 1.0}, Vec3::Zero()).norm() == 1.0);
}

TEST_CASE("A shifted region means the same points seen from another origin", "[region]") {
  const Region regions[] = {BoxRegion{Vec3(-0.1, 0.0, 0.2), Vec3(0.3, 0.1, 0.5)},
                            SphereRegion{Vec3(0.1, 0.05, 0.3), 0.1},
                            HalfSpaceRegion{Vec3(0.1, 0.05, 0.3), Vec3(1, -2, 0.5)}};
  const Vec3 origin(0.7, -0.2, 0.4);
  shapes::Random random(8);
  for (const Region &region : regions)
    for (int k = 0; k < 20; ++k) {
      const Vec3 x = random.vector();
      CHECK(signedDistance(shifted(region, origin), x - origin) == Approx(signedDistance(region, x)).margin(1e-14));
    }
  CHECK(contains(shifted(EverywhereRegion{}, origin), Vec3(9, 9, 9)));
}

TEST_CASE("What is wrong with a region is said with its value", "[region]") {
  CHECK(validate(EverywhereRegion{}));
  CHECK(validate(BoxRegion{Vec3(0, 0, 0), Vec3(1, 1, 0)}));
  CHECK(validate(SphereRegion{Vec3::Zero(), 1e-9}));
  CHECK(validate(HalfSpaceRegion{Vec3::Zero(), Vec3(0, 0, -7)}));

  const auto empty = validate(BoxRegion{Vec3(0.5, 0, 0), Vec3(0.25, 1, 1)});
  REQUIRE_FALSE(empty);
  CHECK(empty.error().find("[0.5, 0, 0]") != std::string::npos);
  CHECK(empty.error().find("[0.25, 1, 1]") != std::string::npos);
  CHECK_FALSE(validate(BoxRegion{Vec3(0, 0, -kInfinity), Vec3(1, 1, 1)}));

  const auto radius = validate(SphereRegion{Vec3::Zero(), -0.5});
  REQUIRE_FALSE(radius);
  CHECK(radius.error().find("-0.5") != std::string::npos);
  CHECK_FALSE(validate(SphereRegion{Vec3::Zero(), 0.0}));
  CHECK_FALSE(validate(SphereRegion{Vec3(std::nan(""), 0, 0), 1.0}));

  CHECK_FALSE(validate(HalfSpaceRegion{Vec3::Zero(), Vec3::Zero()}));
  CHECK_FALSE(validate(HalfSpaceRegion{Vec3::Zero(), Vec3(std::nan(""), 0, 1)}));
}
