// SPDX-License-Identifier: Apache-2.0
// Bodies thinner than their lattice: skins, points of contact, energy; and interactions of bodies.
#include <cmath>
#include <map>

#include "contact_cases.h"
#include "lattice_cases.h"
#include "stepping/monitoring/skin_watch.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using namespace shapes;

namespace {

// Along x, with square sections of half widths h.
Surface swept(const std::vector<std::pair<double, double>> &sections) {
  Surface out;
  for (const auto &[x, h] : sections)
    for (const auto &[y, z] : {std::pair(-1.0, -1.0), std::pair(1.0, -1.0), std::pair(1.0, 1.0), std::pair(-1.0, 1.0)})
      out.positions.emplace_back(x, h * y, h * z);
  const auto rings = static_cast<Index>(sections.size());
  for (Index r = 0; r + 1 < rings; ++r)
    for (Index k = 0; k < 4; ++k) {
      const Index a = 4 * r + k, b = 4 * r + (k + 1) % 4;
      out.triangles.push_back({a, b, a + 4});
      out.triangles.push_back({b, b + 4, a + 4});
    }
  const Index last = 4 * (rings - 1);
  out.triangles.insert(out.triangles.end(),
                       {{0, 2, 1}, {0, 3, 2}, {last, last + 1, last + 2}, {last, last + 2, last + 3}});
  return out;
}

std::shared_ptr<const RestState> laidOut(const Surface &surface, double spacing) {
  return restState(inside(surface), {.sampling = {.spacing = spacing, .count = 0}},
                   std::vector<Vec3>(surface.positions.size(), Vec3::Zero()));
}

Constitution soft(double youngsModulus = 6000.0) { return {{rubber(youngsModulus)}, kLatticeStabilisation}; }

}  // namespace

TEST_CASE("a piece much smaller than its cell touches with as many points as hold it up") {
  const Surface pieces = joined(boxSurface(Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.1), 8),
                                boxSurface(Vec3(0.15, 0.05, 0.05), Vec3(0.168, 0.068, 0.068), 6));
  const auto rest = laidOut(pieces, 0.04);
  REQUIRE(rest->components == 2);
  std::size_t small = 0;
  double area = 0.0;
  for (std::size_t p = 0; p < rest->contact.count(); ++p) {
    area += rest->contact.areas[p];
    if (rest->origin[0] + rest->contact.binding.positions[p][0] > 0.12) ++small;
  }
  CHECK(small >= kMinPointsPerPiece);
  CHECK_THAT(area, WithinRel(areaOf(pieces), 1e-9));
}

TEST_CASE("the skin of a bridge that the lattice cannot see spans the gap as a band, whatever its pieces do") {
  std::vector<std::pair<double, double>> sections{{0.0, 0.03}, {0.06, 0.03}};
  for (int k = 0; k <= 40; ++k) sections.emplace_back(0.0601 + 0.001 * k, 0.0006);
  sections.emplace_back(0.1002, 0.03);
  sections.emplace_back(0.16, 0.03);
  const Surface dumbbell = swept(sections);
  const double spacing = 0.02;
  Body body("dumbbell", laidOut(dumbbell, spacing), soft(), serialFor());
  const RestState &rest = body.rest();
  REQUIRE(rest.components == 2);

  std::vector<Vec3> skin(rest.surfels.count()), none;
  const auto move = [&](const auto &displacement) {
    for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
      body.state().displacements[i] = displacement(rest.positions[i]);
    updateSurfels(rest.surfels, {}, rest.positions, body.state().displacements, skin, none, serialFor());
  };
  // Affine motions are reproduced as everywhere.
  Mat3 A;
  A << 0.1, 0.2, 0.0, -0.1, 0.3, 0.1, 0.0, 0.1, -0.2;
  move([&](const Vec3 &X) { return Vec3(A * X + Vec3(1, 2, 3)); });
  double error = 0.0;
  for (std::size_t p = 0; p < skin.size(); ++p) {
    const Vec3 X = dumbbell.positions[p] - rest.origin;
    error = std::max(error, (skin[p] - X - A * X - Vec3(1, 2, 3)).norm());
  }
  CHECK(error < 1e-12);

  // One piece moves away by two spacings: no edge is longer than a transition band of half a spacing on either side
  // makes it.
  const double way = 2.0 * spacing;
  move([&](const Vec3 &X) { return Vec3(rest.origin[0] + X[0] > 0.08 ? way : 0.0, 0.0, 0.0); });
  double most = 0.0;
  for (const auto &t : rest.skin)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      most = std::max(most, (skin[a] - skin[b]).norm() / (dumbbell.positions[a] - dumbbell.positions[b]).norm());
    }
  INFO("longest edge " << most << " times its length");
  CHECK(most > 1.5);
  CHECK(most < 10.0);  // 41 where one edge spans all of it
}

TEST_CASE("a body that the sampling has torn is told of, one of as many pieces is not") {
  const auto warned = [](const Surface &surface, double spacing) {
    Simulator simulator;
    const auto rest = laidOut(surface, spacing);
    REQUIRE(rest->components == 2);
    simulator.addBody(std::make_unique<Body>("body", rest, soft(), serialFor()));
    const auto tells = [](const SimulationEvent &e) {
      return e.kind == "warning" && Contains("1 connected piece,").match(e.text) &&
             Contains("make 2 parts").match(e.text);
    };
    const auto count = [&] {
      return std::count_if(simulator.diagnostics().events().begin(), simulator.diagnostics().events().end(), tells);
    };
    const auto before = count();
    simulator.reset();
    CHECK(count() == before);
    return before;
  };
  std::vector<std::pair<double, double>> dumbbell{{0.0, 0.03},      {0.06, 0.03},   {0.0601, 0.0006},
                                                  {0.1001, 0.0006}, {0.1002, 0.03}, {0.16, 0.03}};
  CHECK(warned(swept(dumbbell), 0.02) == 1);
  CHECK(warned(joined(boxSurface(Vec3(0, 0, 0), Vec3(0.06, 0.06, 0.06), 4),
                      boxSurface(Vec3(0.1, 0, 0), Vec3(0.16, 0.06, 0.06), 4)),
               0.02) == 0);
}

TEST_CASE("points far outside of every cell are carried by functions that grow with the way, not with its cube") {
  const LatticeBody body =
      lattice_cases::filled(lattice_cases::ball(Vec3::Zero(), 0.05), lattice_cases::withSpacing(0.02));
  for (const double cells : {0.6, 1.0, 3.0, 10.0}) {
    const Vec3 at = Vec3::Constant(0.05 / std::sqrt(3.0) + 0.02 * cells) - body.origin;
    const Interpolation binding = body.cells->bind(std::span(&at, 1), {}, serialFor());
    double sum = 0.0, size = 0.0;
    Vec3 mean = Vec3::Zero();
    for (Index e = 0; e < binding.phyxels.offsets[1]; ++e) {
      sum += binding.weights[e];
      size += std::abs(binding.weights[e]);
      mean += binding.weights[e] * body.positions[binding.phyxels.indices[e]];
    }
    CHECK_THAT(sum, WithinAbs(1.0, 1e-12));
    CHECK((mean - at).norm() < 1e-12);
    CHECK(size < 1.0 + 6.0 * (cells + 1.0));
  }
}

TEST_CASE("energy that comes from nothing is taken back with the steps that brought it") {
  const auto run = [](bool isNear, bool poked, std::vector<SimulationEvent> *events) {
    Simulator simulator;
    WorldSettings world{.gravity = Vec3::Zero()};
    if (isNear) world.dt = 2e-5;  // they stay next to each other
    simulator.setWorld(world);
    auto body = latticeBox(Vec3::Zero(), Vec3(0.08, 0.04, 0.04), 0.01, rubber(1e4), 4);
    for (std::size_t i = 0; i < body->rest().phyxelCount(); ++i)
      body->state().velocities[i] = Vec3(0, 0.2 * std::sin(40.0 * body->rest().positions[i][0]), 0);
    const std::size_t id = simulator.addBody(std::move(body));
    // So near that they are stepped together, but do not touch.
    if (isNear) simulator.addBody(latticeBox(Vec3(0, 0.044, 0), Vec3(0.08, 0.084, 0.04), 0.01, rubber(1e4), 4));
    for (int k = 0; k < 384; ++k) {
      // After the check at step 256, before the one at 384.
      if (poked && k == 300)
        for (Vec3 &v : simulator.body(id)->state().velocities) v *= 4.0;
      REQUIRE(simulator.step());
    }
    if (events) *events = simulator.diagnostics().events();
    return totalEnergy(simulator, id);
  };
  for (const bool isNear : {false, true}) {
    CAPTURE(isNear);
    std::vector<SimulationEvent> events;
    const double calm = run(isNear, false, nullptr), poked = run(isNear, true, &events);
    CHECK_THAT(poked, WithinRel(calm, 0.02));
    const bool told =
        std::any_of(events.begin(), events.end(), [](const SimulationEvent &e) { return e.kind == "smaller_step"; });
    CHECK(told);
  }
}

TEST_CASE("two skins that overlap are found, with their depth and volume") {
  const auto boxAt = [](double x) {
    return latticeBox(Vec3(x, 0, 0), Vec3(x + 0.06, 0.06, 0.06), 0.01, rubber(1e4), 12);
  };
  const auto fixed = boxAt(0.0);
  CHECK(overlapOf(*fixed, *boxAt(0.2)).depth == 0.0);
  CHECK(overlapOf(*fixed, *boxAt(0.0605)).depth == 0.0);
  for (const double depth : {0.003, 0.008}) {
    // Slightly offset, so that edges do not coincide with edges.
    const Overlap found = overlapOf(*fixed, *boxAt(0.06 - depth));
    CHECK_THAT(found.depth, WithinRel(depth, 0.1));
    CHECK_THAT(found.volume, WithinRel(depth * 0.06 * 0.06, 0.4));
  }
}

TEST_CASE("bodies that pass through each other are told of once, and nobody else") {
  Simulator simulator;
  simulator.world().setContact({false, false, 0.3});
  simulator.setWorld({.gravity = Vec3::Zero()});
  auto thrown = latticeBox(Vec3(0, 0.062, 0), Vec3(0.04, 0.102, 0.04), 0.01, rubber(1e6), 8);
  thrown->setInitialVelocity(Vec3(0, -1, 0), Vec3::Zero());
  simulator.addBody(std::move(thrown));
  simulator.addBody(latticeBox(Vec3(0, 0, 0), Vec3(0.06, 0.06, 0.06), 0.01, rubber(1e6), 8));
  simulator.addBody(latticeBox(Vec3(0.3, 0, 0), Vec3(0.36, 0.06, 0.06), 0.01, rubber(1e6), 8));
  while (simulator.time() < 0.03) REQUIRE(simulator.step());
  std::size_t told = 0;
  for (const SimulationEvent &event : simulator.diagnostics().events())
    if (event.kind == "overlap") {
      ++told;
      CHECK(event.time > 0.002);
    }
  CHECK(told == 1);
}

TEST_CASE("pairs of many bodies are looked at in turn, and each that overlaps is found") {
  Simulator simulator;
  simulator.world().setContact({false, false, 0.3});
  simulator.setWorld({.gravity = Vec3::Zero()});
  // They meet in the middle.
  constexpr int kBodies = 6;
  for (int k = 0; k < kBodies; ++k) {
    const double x = 0.05 * (k - 0.5 * (kBodies - 1));
    auto body = latticeBox(Vec3(x, 0, 0), Vec3(x + 0.04, 0.04, 0.04), 0.01, rubber(1e5), 8);
    body->setInitialVelocity(Vec3(-1.5 * x, 0, 0), Vec3::Zero());
    simulator.addBody(std::move(body));
  }
  std::vector<std::string> told;
  const auto look = [&] {
    told.clear();
    for (const SimulationEvent &event : simulator.diagnostics().events())
      if (event.kind == "overlap") told.push_back(event.text);
  };
  REQUIRE(simulator.step());
  look();
  CHECK(told.empty());
  while (simulator.time() < 0.9) REQUIRE(simulator.step());
  look();
  CHECK(told.size() == kBodies * (kBodies - 1) / 2);
  std::sort(told.begin(), told.end());
  CHECK(std::unique(told.begin(), told.end()) == told.end());
}

TEST_CASE("the depth of a penetration is that of the skin that is drawn") {
  Body body("tube", laidOut(boxSurface(Vec3(0, 0, 0), Vec3(0.06, 0.02, 0.02), 6), 0.02), soft(), serialFor());
  WorldBox box;
  box.enabled = true;
  box.min = Vec3(-1, 0, -1);
  std::vector<Vec3> skin;
  CHECK(skinDepth(body, {}, box, 0.0, skin, serialFor()) < 1e-12);
  for (Vec3 &u : body.state().displacements) u[1] = -0.003;
  CHECK_THAT(skinDepth(body, {}, box, 0.0, skin, serialFor()), WithinRel(0.003, 1e-9));
  const Obstacle ground = halfSpace(Vec3(0, 0.001, 0), Vec3(0, 1, 0), 0.3);
  CHECK_THAT(skinDepth(body, std::span(&ground, 1), WorldBox(), 0.0, skin, serialFor()), WithinRel(0.004, 1e-9));
}

TEST_CASE("a region to refine that meets no part of the body is refused by its number") {
  LatticeSampling sampling = lattice_cases::withSpacing(0.02);
  sampling.refinements.push_back({SphereRegion{Vec3(0.05, 0, 0), 0.01}, 0.01});
  sampling.refinements.push_back({SphereRegion{Vec3(1.0, 0, 0), 0.01}, 0.01});
  const auto filled = fillLattice(lattice_cases::ball(Vec3::Zero(), 0.05), sampling, serialFor());
  REQUIRE_FALSE(filled);
  CHECK_THAT(filled.error(), Contains("refinement 1:"));
  CHECK_THAT(filled.error(), Contains("accepted"));
  sampling.refinements.pop_back();
  CHECK(fillLattice(lattice_cases::ball(Vec3::Zero(), 0.05), sampling, serialFor()));
}
