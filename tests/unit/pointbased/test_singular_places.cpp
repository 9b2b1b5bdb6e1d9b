// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/simulator.h"
#include "pointbased/singular_places.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

struct Problem {
  BodyShape shape;
  std::vector<Fix> fixes;
  std::vector<Load> loads;
  double poissonRatio = 0.0;
};

std::unique_ptr<Body> bodyOf(const Problem &problem, double spacing) {
  BodyRecipe recipe;
  recipe.sampling.spacing = spacing;
  recipe.fixes = problem.fixes;
  recipe.loads = problem.loads;
  auto rest = buildRestState(problem.shape, recipe, {}, serialFor());
  REQUIRE(rest);
  Material material;
  material.youngsModulus = 1e4;
  material.poissonRatio = problem.poissonRatio;
  return std::make_unique<Body>("body", *rest, Constitution{{material}, kLatticeStabilisation}, serialFor());
}

Fix held(const Region &region, const Vec3 &displacement = Vec3::Zero()) {
  Fix fix;
  fix.region = region;
  fix.displacement = displacement;
  return fix;
}

Problem bending() {
  Problem out;
  out.shape = lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  out.fixes = {held(HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()})};
  out.loads.resize(1);
  out.loads[0].region = HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()};
  out.loads[0].force = Vec3(0, 0, -1.6e-3);
  return out;
}

Vec3 centreOf(const Body &body, std::size_t q) { return body.rest().origin + body.rest().pointCentres[q]; }

}  // namespace

TEST_CASE("the edge of a support is left out, two spacings around it, and no more") {
  const double d = 0.008;
  const auto body = bodyOf(bending(), d);
  const SingularPlaces places = findSingularPlaces(*body, {});
  CHECK(places.fixes == std::vector<std::size_t>{0});
  CHECK_FALSE(places.contact);
  CHECK_FALSE(places.hands);
  REQUIRE(places.points.size() == body->rest().pointCount());
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    const Vec3 x = centreOf(*body, q);
    // The rim is the border of the face x = 0.
    const double toSide = std::min({x[1], 0.04 - x[1], x[2], 0.04 - x[2]});
    const double toRim = std::hypot(x[0], toSide);
    INFO("at " << x.transpose());
    // Points of the skin lie up to half a spacing off the rim itself.
    if (toRim < (kSingularSpacings - 0.6) * d) CHECK(places.points[q] == 1);
    if (x[0] > kSingularSpacings * d) CHECK(places.points[q] == 0);
  }
  CHECK(places.volumePart > 0.02);
  CHECK(places.volumePart < 2.0 * d / 0.2 + 1e-9);
}

TEST_CASE("a support inside of a body has all of its border as edge, and a body without any has none") {
  Problem free;
  free.shape = lattice_cases::box(Vec3::Zero(), Vec3::Constant(0.1));
  CHECK(findSingularPlaces(*bodyOf(free, 0.01), {}).volumePart == 0.0);
  Problem inside = free;
  inside.fixes = {held(BoxRegion{Vec3::Constant(0.04), Vec3::Constant(0.06)})};
  const auto body = bodyOf(inside, 0.01);
  const SingularPlaces places = findSingularPlaces(*body, {});
  CHECK(places.fixes.size() == 1);
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    const double off = (centreOf(*body, q) - Vec3::Constant(0.05)).lpNorm<Eigen::Infinity>();
    if (off > 0.01 && off < 0.02) CHECK(places.points[q] == 1);
    if (off > 0.042) CHECK(places.points[q] == 0);
  }
}
