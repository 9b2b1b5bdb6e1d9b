// SPDX-License-Identifier: Apache-2.0
// Tools in slices: the part of a body currently at a position, its held part, and where a ball is clear of skins.
#include <Eigen/Geometry>
#include <numeric>

#include "instruments/clear_position.h"
#include "instruments/grab_patch.h"
#include "lattice_cases.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

/// 60 x 60 x 60 mm; held in its lowest 6 mm, or in the given region.
std::shared_ptr<const RestState> heldBlock(const Region &held = HalfSpaceRegion{Vec3(0, 0, 0.306), Vec3::UnitZ()}) {
  BodyRecipe recipe;
  recipe.sampling = lattice_cases::withSpacing(0.006);
  recipe.sampling.materials = {{HalfSpaceRegion{Vec3(0, 0, 0.33), Vec3::UnitZ()}, std::uint16_t{1}},
                               {HalfSpaceRegion{Vec3(0, 0, 0.315), Vec3::UnitZ()}, std::uint16_t{2}}};
  recipe.fixes.emplace_back();
  recipe.fixes.back().region = held;
  const BodyShape shape = lattice_cases::box(Vec3(0.1, 0.2, 0.3), Vec3(0.16, 0.26, 0.36));
  std::vector<Vec3> normals(shape.surface.positions.size(), Vec3::UnitX());
  auto rest = buildRestState(shape, recipe, normals, serialFor());
  if (!rest) throw std::runtime_error(rest.error());
  return *rest;
}

template <class Way>
std::vector<Vec3> moved(const RestState &rest, const Way &way) {
  std::vector<Vec3> now;
  for (const Vec3 &X : rest.positions) now.push_back(way(Vec3(rest.origin + X)));
  return now;
}

}  // namespace

TEST_CASE("The material at a place is found however far a body has gone, turned and stretched", "[slices]") {
  const auto rest = heldBlock();
  Mat3 F = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  F *= Vec3(1.4, 0.8, 0.9).asDiagonal();
  const auto way = [&](const Vec3 &X) { return Vec3(F * X + Vec3(3.0, -1.0, 0.5)); };
  const std::vector<Vec3> now = moved(*rest, way);
  for (const Vec3 &X : {Vec3(0.13, 0.23, 0.33), Vec3(0.1413, 0.2127, 0.3499), Vec3(0.159, 0.259, 0.359)}) {
    const auto found = materialAt(*rest, now, way(X));
    REQUIRE(found);
    CHECK((rest->origin + found->at - X).norm() < 1e-5);  // least-squares regularisation: 1e-6 of the spacing squared
  }
  CHECK_FALSE(materialAt(*rest, {}, Vec3::Zero()));
}

TEST_CASE("Of a body that lies folded over itself one layer is taken, not a mean of both", "[slices]") {
  const auto rest = heldBlock();
  const double middle = 0.13;
  // The half beyond the middle has been folded onto the other one, 2 mm higher.
  const auto way = [&](const Vec3 &X) { return X[0] <= middle ? X : Vec3(2.0 * middle - X[0], X[1], X[2] + 0.002); };
  const std::vector<Vec3> now = moved(*rest, way);
  const Vec3 X(0.109, 0.23, 0.33);
  const auto found = materialAt(*rest, now, way(X));
  REQUIRE(found);
  const Vec3 at = rest->origin + found->at, other(2.0 * middle - X[0], X[1], X[2] - 0.002);
  CHECK(std::min((at - X).norm(), (at - other).norm()) < 1e-5);
}

TEST_CASE("Crushed phyxels lead no farther than their surroundings", "[slices]") {
  const auto rest = heldBlock();
  const std::vector<Vec3> now = moved(*rest, [](const Vec3 &X) { return Vec3(1e-9 * X); });
  const auto found = materialAt(*rest, now, Vec3(0.1, 0.1, 0.1));
  REQUIRE(found);
  CHECK((found->at - rest->positions.front()).norm() < 0.2);
}

TEST_CASE("A point inside is held by the patch around it, and what a fix holds is told", "[slices]") {
  const auto rest = heldBlock();
  const std::vector<Vec3> now = moved(*rest, [](const Vec3 &X) { return X; });
  const PinchSettings settings{.radius_mm = 15.0};
  const auto inside = materialAt(*rest, now, Vec3(0.13, 0.23, 0.335));
  REQUIRE(inside);
  CHECK_FALSE(inside->isHeld);
  const Grab grab = grabAt(*rest, inside->at, settings, 6e3);
  CHECK(grab.phyxels.size() > 20);
  CHECK_THAT(std::accumulate(grab.weights.begin(), grab.weights.end(), 0.0), WithinAbs(1.0, 1e-12));
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    CHECK((rest->positions[grab.phyxels[k]] - inside->at).norm() < 0.015);
    mean += grab.weights[k] * now[grab.phyxels[k]];
  }
  CHECK((mean - Vec3(0.13, 0.23, 0.335)).norm() < 0.001);
  CHECK_THAT(grab.maxForce, WithinRel(4.0 * 6e3 * 0.015 * 0.015, 1e-12));
  const auto below = materialAt(*rest, now, Vec3(0.13, 0.23, 0.302));
  REQUIRE(below);
  CHECK(below->isHeld);
}

// The phyxel nearest to it is mostly held: tissue next to bone could not be grabbed.
TEST_CASE("What is held at a place is what the support holds, not the phyxel nearest to it", "[slices]") {
  // Flat borders of the held region would pass through the centres of cells.
  const auto upTo = [](double z) { return SphereRegion{Vec3(0.13, 0.23, 0.28), z - 0.28}; };
  double layer = 1.0;  // of phyxels
  const auto whole = heldBlock(upTo(0.306));
  for (const Vec3 &X : whole->positions)
    if (const double z = (whole->origin + X)[2]; z > 0.303) layer = std::min(layer, z);
  const double border = layer + 0.0015, beside = border + 1e-4;
  const auto rest = heldBlock(upTo(border));
  const std::vector<Vec3> now = moved(*rest, [](const Vec3 &X) { return X; });
  const auto held = materialAt(*rest, now, Vec3(0.13, 0.23, border - 1e-4));
  REQUIRE(held);
  CHECK(held->isHeld);
  const Vec3 place(0.13, 0.23, beside);
  const auto nearest = std::min_element(now.begin(), now.end(), [&](const Vec3 &a, const Vec3 &b) {
    return (a - place).squaredNorm() < (b - place).squaredNorm();
  });
  REQUIRE((*nearest)[2] < border);
  const auto free = materialAt(*rest, now, place);
  REQUIRE(free);
  CHECK_FALSE(free->isHeld);
  // By the share of a load on the material that moves.
  const Grab grab = grabAt(*rest, free->at, {.radius_mm = 12.0}, 6e3);
  REQUIRE(!grab.phyxels.empty());
  const double radius = 0.012;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    const Index i = grab.phyxels[k];
    const double moves = rest->weightVolumes[i] - rest->heldVolumes[i];
    const double kernel = kernelWeight((rest->positions[i] - free->at).norm(), radius);
    const double first = rest->weightVolumes[grab.phyxels[0]] - rest->heldVolumes[grab.phyxels[0]];
    const double firstKernel = kernelWeight((rest->positions[grab.phyxels[0]] - free->at).norm(), radius);
    CHECK_THAT(grab.weights[k] * first * firstKernel, WithinRel(grab.weights[0] * moves * kernel, 1e-9));
  }
}

TEST_CASE("The tissue at a place is the last one whose region holds it, or whose border is at hand", "[slices]") {
  const auto rest = heldBlock();
  const auto numberAt = [&](double z) { return materialNumberAt(*rest, Vec3(0.13, 0.23, z) - rest->origin); };
  CHECK(numberAt(0.31) == 2);
  CHECK(numberAt(0.325) == 1);
  CHECK(numberAt(0.3301) == 1);
  CHECK(numberAt(0.335) == 0);
}

TEST_CASE("A ball stands where it is put, or beside the skin within its plane", "[slices]") {
  // A spherical skin of 30 mm about the origin.
  const auto skin = [](const Vec3 &at) {
    return SkinDistance{at.norm() - 0.03, at.norm() > 0.0 ? Vec3(at.normalized()) : Vec3::UnitX()};
  };
  const Vec3 z = Vec3::UnitZ();
  const Vec3 free(0.05, 0.0, 0.0);
  CHECK(clearPosition(free, z, 0.006, skin) == free);
  for (const Vec3 &place : {Vec3(0.031, 0, 0), Vec3(0.02, 0.02, 0.0), Vec3(0.001, 0.0, 0.0), Vec3(0.0, 0.01, 0.02)}) {
    const auto at = clearPosition(place, z, 0.006, skin);
    REQUIRE(at);
    CHECK_THAT((*at)[2], WithinAbs(place[2], 1e-12));
    CHECK_THAT(at->norm(), WithinAbs(0.036, 2e-5));
    CHECK(std::abs((*at)[0] * place[1] - (*at)[1] * place[0]) < 1e-9);  // straight outwards
  }
  // The plane touches the skin from above: no short displacement within it clears the skin.
  CHECK_FALSE(clearPosition(Vec3(0, 0, 0.029), z, 0.006, skin));
}
