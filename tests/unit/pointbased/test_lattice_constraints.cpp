// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "lattice_cases.h"
#include "support/catch.h"

using namespace lattice_cases;

namespace {

BodyShape beam(double from = 0.0) { return box(Vec3(from, -0.02, -0.02), Vec3(0.2, 0.02, 0.02)); }

LatticeSampling holding(double spacing, const Region &region, const Mat3 &axes = Mat3::Identity()) {
  LatticeSampling sampling = withSpacing(spacing);
  sampling.axes = axes;
  sampling.held = {region};
  return sampling;
}

Region leftOf(double x) { return HalfSpaceRegion{Vec3(x, 0, 0), Vec3::UnitX()}; }

// Σ φ X of every row, world.
std::vector<Vec3> rowCentres(const LatticeBody &body, const ConstrainedRegion &held) {
  std::vector<Vec3> centres;
  for (std::size_t r = 0; r < held.areas.size(); ++r) {
    Vec3 centre = body.origin;
    double weight = 0.0;
    for (Index e = held.rows.offsets[r]; e < held.rows.offsets[r + 1]; ++e) {
      centre += held.weights[e] * body.positions[held.rows.indices[e]];
      weight += held.weights[e];
    }
    CHECK_THAT(weight, WithinAbs(1.0, 1e-12));
    centres.push_back(centre);
  }
  return centres;
}

}  // namespace

TEST_CASE("the border of a held region lies where the region says, not where cells end") {
  for (const double spacing : {0.04 / 3, 0.01, 0.007})
    for (const int turn : {0, 1, 2}) {
      INFO("spacing " << spacing << ", turn " << turn);
      const Mat3 axes = turn == 0   ? Mat3(Mat3::Identity())
                        : turn == 1 ? rotation(1, 30)
                                    : Mat3(rotation(0, 20) * rotation(1, 35));
      const LatticeBody body = filled(beam(), holding(spacing, leftOf(0.0213), axes));
      REQUIRE(body.held.size() == 1);
      const ConstrainedRegion &held = body.held[0];
      for (const Vec3 &centre : rowCentres(body, held)) CHECK_THAT(centre[0], WithinAbs(0.0213, 1e-6));
      // Aligned borders are exact but for the edges of the beam; slanted ones are measured by 4³ points per cell.
      CHECK_THAT(sum(held.areas), WithinRel(0.04 * 0.04, turn == 0 ? 5e-3 : 0.06));
      CHECK_THAT(sum(body.stencils.volumes), WithinRel(0.04 * 0.04 * (0.2 - 0.0213), 0.01));
      CHECK_THAT(held.volume, WithinRel(0.04 * 0.04 * 0.0213, 0.01));
      CHECK_THAT(held.area, WithinRel(0.04 * 0.04 + 4.0 * 0.04 * 0.0213, 2e-3));
      CHECK((body.origin + held.centroid - Vec3(0.5 * 0.0213, 0, 0)).norm() < 2e-4);
      CHECK_THAT(sum(body.volumes), WithinRel(0.04 * 0.04 * 0.2, 1e-12));
      CHECK(std::is_sorted(held.phyxels.begin(), held.phyxels.end()));
      for (const Index i : held.phyxels) CHECK((body.origin + body.positions[i])[0] < 0.0213);
      CHECK(consistencyOf(body).worst() < 1e-10);
    }
}

TEST_CASE("every phyxel is held, follows a row or belongs to something that deforms") {
  const LatticeBody body = filled(beam(), holding(0.009, leftOf(0.05), rotation(1, 30)));
  std::vector<std::uint8_t> known(body.positions.size(), 0);
  for (const Index i : body.held[0].phyxels) known[i] = 1;
  for (const Index i : body.stencils.phyxels.indices) {
    CHECK((known[i] & 1) == 0);  // the held part itself does not touch deformable material
    known[i] |= 2;
  }
  for (const std::uint8_t k : known) CHECK(k != 0);
}

TEST_CASE("borders of held regions lie in the middle of cells, held faces on corners") {
  // 20 cells of 0.0104 m do not fit 0.2 m; without supports the lattice is symmetric.
  const auto placesAlongX = [](const LatticeBody &body) {
    double least = 1e9;
    for (const Vec3 &X : body.positions) least = std::min(least, (body.origin + X)[0]);
    return least;
  };
  const auto offset = [&](double at, const LatticeBody &body) {
    const double cells = (at - placesAlongX(body)) / body.spacing;
    return cells - std::floor(cells + 1e-9);
  };
  LatticeSampling sampling = withSpacing(0.0104);
  CHECK_THAT(offset(0.1, filled(beam(), sampling)), WithinAbs(0.0, 1e-9) || WithinAbs(0.5, 1e-9));
  sampling.held = {HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}};
  CHECK_THAT(offset(0.0, filled(beam(), sampling)), WithinAbs(0.0, 1e-6));
  sampling.held = {BoxRegion{Vec3(-1, -1, -1), Vec3(0.037, 1, 1)}};
  CHECK_THAT(offset(0.037, filled(beam(), sampling)), WithinAbs(0.5, 1e-6));
  sampling.held = {BoxRegion{Vec3(0.083 - 1e-6, -1, -1), Vec3(0.083 + 1e-6, 1, 1)}};
  CHECK_THAT(offset(0.083, filled(beam(), sampling)), WithinAbs(0.0, 1e-6));
}

TEST_CASE("a lobe that one cell spans is held against turning wherever its border runs through the cells") {
  // Cells on edge, as long across as the beam is thick: borders through their edges have one patch over the thickness,
  // whose mean alone would be a hinge. A fully held section has a twelfth of the square of its thickness.
  const double thickness = 0.04, spacing = thickness / std::sqrt(2.0);
  for (int k = 0; k < 16; ++k) {
    const double x = 0.1 + 0.5 * thickness * k / 16.0;
    INFO("border at " << x);
    const LatticeBody body = filled(beam(), holding(spacing, leftOf(x), rotation(1, 45)));
    const std::vector<Vec3> centres = rowCentres(body, body.held[0]);
    double moment = 0.0;
    for (std::size_t r = 0; r < centres.size(); ++r) moment += body.held[0].areas[r] * std::pow(centres[r][2], 2);
    CHECK(moment / sum(body.held[0].areas) > 0.4 * thickness * thickness / 12.0);
  }
}

TEST_CASE("a face that is held has its phyxels held, where there are some on it") {
  for (const Region &region : {leftOf(0.0), leftOf(1e-4), Region(BoxRegion{Vec3(-1, -1, -1), Vec3(1e-4, 1, 1)})}) {
    const LatticeBody body = filled(beam(), holding(0.01, region));
    CHECK(body.held[0].phyxels.size() == 25);
    for (const Index i : body.held[0].phyxels) CHECK_THAT((body.origin + body.positions[i])[0], WithinAbs(0.0, 1e-12));
    CHECK(body.held[0].areas.empty());
    CHECK_THAT(sum(body.stencils.volumes), WithinRel(0.04 * 0.04 * 0.2, 1e-12));
    CHECK_THAT((body.origin + body.held[0].centroid)[0], WithinAbs(0.0, 1e-4));
  }
  // Off the lattice: patches on the face.
  const BodyShape shape = shifted(beam(), 0.01, Vec3(0.37, 0.21, 0.43));
  const LatticeBody body = filled(shape, holding(0.01, leftOf(0.0)));
  CHECK(body.held[0].phyxels.empty());
  CHECK_THAT(sum(body.held[0].areas), WithinRel(0.04 * 0.04, 1e-3));
  for (const Vec3 &centre : rowCentres(body, body.held[0])) CHECK_THAT(centre[0], WithinAbs(0.0, 1e-9));
}

TEST_CASE("where a held part of a face ends within it, patches place its edge") {
  // Edges at 0.4 of a cell, and on corners: those follow the patches.
  for (const double low : {0.004, 0.0}) {
    INFO("from z = " << low);
    const Region part = BoxRegion{Vec3(-1e-4, -1, low), Vec3(1e-4, 1, 1)};
    const LatticeBody body = filled(beam(), holding(0.01, part));
    const ConstrainedRegion &held = body.held[0];
    CHECK(held.phyxels.size() == 10);
    for (const Index i : held.phyxels) CHECK((body.origin + body.positions[i])[2] > low + 1e-9);
    REQUIRE(held.areas.size() == 4);
    for (const double k : held.stiffness) CHECK(k == kEdgePatchStiffness);
  }
  // The other part of the face is held as well: it has no edge.
  LatticeSampling both = holding(0.01, BoxRegion{Vec3(-1e-4, -1, -1), Vec3(1e-4, 1, 0)});
  both.held.push_back(BoxRegion{Vec3(-1e-4, -1, 0), Vec3(1e-4, 1, 1)});
  const LatticeBody body = filled(beam(), both);
  REQUIRE(body.held.size() == 2);
  CHECK(body.held[0].phyxels.size() + body.held[1].phyxels.size() == 25);
  CHECK(body.held[0].areas.empty());
}

TEST_CASE("a beam bends as if it were clamped at the border of what is held") {
  // The same free length behind held parts of several lengths: 2.033 mm, but for the 1 % or so that a clamp by patches
  // adds at five layers. Half a spacing would be 6 %.
  for (const double length : {0.02, 0.0213, 0.001, 1e-4})
    for (const int turn : {0, 1}) {
      const BodyShape shape = beam(-length);
      const Mat3 axes = turn == 0 ? Mat3(Mat3::Identity()) : rotation(2, 30);
      const LatticeBody body = filled(shape, holding(0.008, leftOf(0.0), axes));
      const double tip =
          solveLinear(body, shape, HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()}, Vec3(0, 0, -1.6e-3)).tip;
      // A layer below a quarter of the spacing acts as its surface: the beam is longer by it.
      const double expected = length < 0.25 * 0.008 ? 2.033e-3 * std::pow(1.0 + length / 0.2, 3) : 2.033e-3;
      INFO("held over " << length << " m, turn " << turn << ": " << 100.0 * (tip / expected - 1.0) << " %");
      CHECK_THAT(tip, WithinRel(expected, 0.013));
    }
}

TEST_CASE("what is held by two regions is counted once") {
  LatticeSampling sampling = holding(0.01, leftOf(0.05));
  sampling.held.push_back(SphereRegion{Vec3(0.05, 0, 0), 0.03});
  const LatticeBody body = filled(beam(), sampling);
  REQUIRE(body.held.size() == 2);
  for (const Index i : body.held[0].phyxels)
    CHECK_FALSE(std::binary_search(body.held[1].phyxels.begin(), body.held[1].phyxels.end(), i));
  CHECK(sum(body.stencils.volumes) < 0.04 * 0.04 * 0.15);
  CHECK(consistencyOf(body).worst() < 1e-10);
}

TEST_CASE("a body can be held everywhere") {
  const LatticeBody body = filled(beam(), holding(0.01, EverywhereRegion{}));
  CHECK(body.held[0].phyxels.size() == body.positions.size());
  CHECK(body.stencils.pointCount() == 0);
  CHECK_THAT(body.held[0].volume, WithinRel(0.04 * 0.04 * 0.2, 1e-12));
}

TEST_CASE("a held region that meets nothing is refused by its number") {
  LatticeSampling sampling = holding(0.01, leftOf(0.01));
  sampling.held.push_back(SphereRegion{Vec3(1, 0, 0), 0.1});
  const auto result = fillLattice(beam(), sampling, serialFor());
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error(), Contains("fix 1: the region meets no part of the body"));
}

TEST_CASE("the largest stable step of a body is about its spacing over the speed of sound, wherever it is held") {
  // The position of these borders is arbitrary relative to the cells: some leave slivers of a hundredth of a cell to
  // deform. Those made steps of 0.03 to 0.6 of the spacing over the speed of sound as long as only free material had a
  // mass there. Free boxes and balls have 0.73 to 0.82.
  const Material material{.youngsModulus = 6e3, .poissonRatio = 0.45};
  const Constitution constitution{.materials = {material}};
  const double speed = std::sqrt(material.waveModulus() / material.restDensity);
  const Vec3 slanted = Vec3(-1.0, 0.5, 0.3).normalized();
  const BodyShape bodies[] = {beam(), ball(Vec3(0.1, 0.0, 0.0), 0.05)};
  for (const BodyShape &shape : bodies)
    for (const double turn : {0.0, 20.0})
      for (const double x : {0.0625, 0.07, 0.0777}) {
        INFO("turned by " << turn << " degrees, held from " << x << " m on");
        BodyRecipe recipe{.sampling = withSpacing(0.01)};
        recipe.sampling.axes = rotation(0, turn) * rotation(1, turn);
        for (const Vec3 &normal : {Vec3(Vec3::UnitX()), slanted}) {
          const Fix fix{.region = HalfSpaceRegion{Vec3(x, 0, 0), normal}};
          recipe.fixes = {fix};
          const auto rest = shapes::restState(shape, recipe);
          const Body body("held", rest, constitution, serialFor());
          CHECK(body.stableStepAtRest() * speed / 0.01 > 0.6);
          // All of the mass moves or is carried, and little more moves than the free part.
          double moving = 0.0, carried = 0.0, loose = 0.0;
          for (std::size_t i = 0; i < rest->phyxelCount(); ++i) {
            carried += body.supportMasses()[i];
            moving += body.masses()[i];
            if (body.inverseMasses()[i] > 0.0)
              loose += body.masses()[i] - material.restDensity * (rest->weightVolumes[i] - rest->heldVolumes[i]);
          }
          CHECK_THAT(moving + carried, WithinRel(material.restDensity * shape.volume, 1e-12));
          CHECK(std::abs(loose) < 0.03 * moving);
        }
      }
}
