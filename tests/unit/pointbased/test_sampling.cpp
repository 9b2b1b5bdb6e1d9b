// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <numeric>

#include "pointbased/lattice.h"
#include "pointbased/sampling.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {
double sum(const std::vector<double> &v) { return std::accumulate(v.begin(), v.end(), 0.0); }
}  // namespace

TEST_CASE("volumes sum to the volume of the body at any spacing") {
  for (const auto &shape :
       {shapes::box(Vec3(0, 0, 0), Vec3(0.2, 0.1, 0.05)), shapes::ball(Vec3(1, 2, 3), 0.08), shapes::horseshoe()})
    for (const double spacing : {0.06, 0.031, 0.013, 0.0077}) {
      const PhyxelCloud cloud = shapes::filled(shape, spacing);
      CHECK_THAT(sum(cloud.volumes), WithinRel(shape.volume, 1e-12));
      for (const double v : cloud.volumes) CHECK(v > 0.0);
    }
}

TEST_CASE("a box of whole cells is divided into equal cells") {
  const PhyxelCloud cloud = shapes::filled(shapes::box(Vec3(0, 0, 0), Vec3(0.2, 0.04, 0.04)), 0.01);
  REQUIRE(cloud.positions.size() == 20 * 4 * 4);
  for (const double v : cloud.volumes) CHECK_THAT(v, WithinRel(1e-6, 1e-9));
  CHECK_THAT(cloud.positions.front()[0], WithinAbs(0.005, 1e-12));
  for (const double r : cloud.contactRadii) CHECK_THAT(r, WithinRel(0.005, 1e-9));
}

TEST_CASE("phyxels lie inside and carry the part of the body around them") {
  const auto shape = shapes::ball(Vec3(0, 0, 0), 0.05);
  const PhyxelCloud cloud = shapes::filled(shape, 0.01);
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    CHECK(cloud.positions[i].norm() < 0.05);
    centre += cloud.volumes[i] * cloud.positions[i];
  }
  // Symmetric except for points halfway between two phyxels, which belong to the first of them.
  CHECK(centre.norm() / shape.volume < 1e-3 * 0.05);
}

TEST_CASE("a wanted count is met within five per cent") {
  for (const std::size_t count : {56u, 498u, 2844u}) {
    const auto cloud = fill(shapes::ball(Vec3(0, 0, 0), 0.05), {0.0, count}, serialFor());
    REQUIRE(cloud);
    CHECK_THAT(static_cast<double>(cloud->positions.size()), WithinRel(static_cast<double>(count), 0.05));
  }
}

TEST_CASE("The automatic count follows the thickness, from 1000 to 4000") {
  const double pi = 3.14159265358979;
  CHECK(automaticCount(4.0 / 3.0 * pi * 1e-3, 4.0 * pi * 1e-2) == 1000);  // a ball, of any size
  CHECK(automaticCount(1e-9, 6e-6) == 1000);
  CHECK(automaticCount(0.1 * 0.1 * 0.001, 2 * 0.1 * 0.1) == 4000);  // a sheet too thin for any sampling
  CHECK(automaticCount(1e-3, std::numeric_limits<double>::infinity()) == 1000);
  // Sheets between the bounds: the spacing is half of the thickness, up to the rounding to whole cells.
  for (const double thickness : {0.010, 0.012, 0.014}) {
    const auto sheet = shapes::box(Vec3(0, 0, 0), Vec3(0.1, 0.1, thickness));
    const double area = 2 * 0.1 * 0.1 + 4 * 0.1 * thickness, mean = 2.0 * sheet.volume / area;
    const LatticeSampling sampling{.count = automaticCount(sheet.volume, area)};
    REQUIRE((sampling.count > 1000 && sampling.count < 4000));
    const auto lattice = fillLattice(sheet, sampling, serialFor());
    REQUIRE(lattice);
    CHECK_THAT(lattice->spacing, WithinRel(0.5 * mean, 0.15));
  }
}

TEST_CASE("a sheet thinner than the spacing still gets phyxels") {
  const auto shape = shapes::box(Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.004));
  const PhyxelCloud cloud = shapes::filled(shape, 0.01);
  CHECK(cloud.positions.size() >= 90);
  CHECK_THAT(sum(cloud.volumes), WithinRel(shape.volume, 1e-12));
}

TEST_CASE("what cannot be filled is refused with the value and what is accepted") {
  const auto shape = shapes::ball(Vec3(0, 0, 0), 0.05);
  CHECK_THAT(fill(shape, {-0.01, 0}, serialFor()).error(), Contains("spacing"));
  CHECK_THAT(fill(shape, {std::nan(""), 0}, serialFor()).error(), Contains("spacing"));
  CHECK_THAT(fill(shape, {1e-5, 0}, serialFor()).error(), Contains("larger spacing"));
  CHECK_THAT(fill(shape, {0.0, 0}, serialFor()).error(), Contains("count"));
  auto flat = shape;
  flat.volume = 0.0;
  CHECK_THAT(fill(flat, {0.01, 0}, serialFor()).error(), Contains("volume"));
}

TEST_CASE("a fill can be cancelled") {
  const auto result = fill(shapes::ball(Vec3(0, 0, 0), 0.05), {0.01, 0}, serialFor(), [](double) { return false; });
  REQUIRE_FALSE(result);
  CHECK(result.error() == "cancelled");
}
