// SPDX-License-Identifier: Apache-2.0
// Points of contact that are not checked, and corners that reach almost none of the body.
#include <algorithm>

#include "contact_cases.h"
#include "lattice_cases.h"
#include "pointbased/integrators.h"
#include "stepping/monitoring/guard.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

// A ball on a lattice: its surface leaves slivers in cells, whose far corners are light.
std::unique_ptr<Body> ballOnLattice(const Vec3 &centre, double youngsModulus = 6e3) {
  const BodyShape shape = lattice_cases::ball(centre, 0.05);
  const Material material{.youngsModulus = youngsModulus};
  return shapes::makeBody(shapes::restState(shape, {.sampling = lattice_cases::withSpacing(0.0137)}), {material});
}

Index lightest(const Body &body) {
  const auto &maxInfluence = body.rest().maxInfluence;
  return static_cast<Index>(std::min_element(maxInfluence.begin(), maxInfluence.end()) - maxInfluence.begin());
}

}  // namespace

TEST_CASE("blocks of points that wait miss no contact, however phyxels and obstacles move") {
  const std::unique_ptr<Body> body = ballOnLattice(Vec3(0, 0.07, 0));
  const RestState &rest = body->rest();
  const double dt = 1e-3, margin = 2e-4;
  std::vector<Obstacle> obstacles{shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3),
                                  shapes::halfSpace(Vec3(0.1, 0, 0), Vec3(-1, 0, 0), 0.3)};
  obstacles[1].motion = [](double t) { return RigidMotion{.displacement = Vec3(-0.05 * std::sin(20.0 * t), 0, 0)}; };
  const WorldBox box{true, Vec3(-1, -1, -0.06), Vec3(1, 1, 1), 0.2};
  shapes::Random random(3);
  std::vector<Vec3> u(rest.phyxelCount(), Vec3::Zero()), v(rest.phyxelCount(), Vec3::Zero());
  std::vector<Vec3> positions(rest.contact.count()), velocities(rest.contact.count());
  ContactState waiting, all;
  std::size_t found = 0, looked = 0;
  for (int step = 0; step < 400; ++step) {
    // The body oscillates; its corners move independently, and those that move little of it move far.
    const double time = step * dt;
    for (std::size_t i = 0; i < u.size(); ++i) {
      v[i] = Vec3(0.2 * std::cos(15.0 * time), 0.4 * std::cos(9.0 * time) - 0.1, 0.1) +
             0.05 / static_cast<double>(rest.maxInfluence[i]) * random.vector();
    }
    const CarriedPoints carried{rest.contact, rest.origin, u, v, rest.maxInfluence};
    findContacts(obstacles, box, time, dt, margin, carried, waiting, serialFor());
    interpolateDisplacements(rest.contact.binding, rest.positions, u, positions, serialFor());
    interpolateField(rest.contact.binding, v, velocities, serialFor());
    for (std::size_t p = 0; p < positions.size(); ++p) positions[p] += rest.origin + rest.contact.binding.positions[p];
    findContacts(obstacles, box, time, dt, margin, positions, velocities, {}, all, serialFor());
    looked += waiting.blocks.checkedPoints.size();
    found += all.active.size();
    REQUIRE(waiting.active.size() == all.active.size());
    for (std::size_t c = 0; c < all.active.size(); ++c) {
      REQUIRE(waiting.active[c].point == all.active[c].point);
      REQUIRE(waiting.active[c].obstacle == all.active[c].obstacle);
    }
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += dt * v[i];
  }
  CHECK(found > 1000);
  CHECK(looked < 400 * rest.contact.count() / 2);
}

TEST_CASE("the largest influence of a phyxel bounds what a point of contact goes with it, and is 1 within the body") {
  const std::unique_ptr<Body> body = ballOnLattice(Vec3::Zero());
  const RestState &rest = body->rest();
  REQUIRE(rest.maxInfluence.size() == rest.phyxelCount());
  const Interpolation &points = rest.contact.binding;
  for (std::size_t e = 0; e < points.weights.size(); ++e)
    REQUIRE(static_cast<double>(rest.maxInfluence[points.phyxels.indices[e]]) >= std::abs(points.weights[e]));
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    if (rest.positions[i].norm() < 0.02) CHECK(rest.maxInfluence[i] == Approx(1.0));
  CHECK(rest.maxInfluence[lightest(*body)] < 0.2);
}

TEST_CASE("a corner that hardly anything of the body reaches may be fast without dividing the steps") {
  const auto partsAt = [](const auto &choose) {
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3::Zero()});
    const std::size_t id = simulator.addBody(ballOnLattice(Vec3::Zero()));
    Body &body = *simulator.body(id);
    REQUIRE(simulator.step());
    // Two thirds of a spacing in a step, where a quarter is allowed.
    body.state().velocities[choose(body)] = Vec3(0.67 * body.rest().spacing / simulator.time(), 0, 0);
    REQUIRE(simulator.step());
    return shapes::countEvents(simulator, "substep");
  };
  CHECK(partsAt([](const Body &body) { return lightest(body); }) == 0);
  CHECK(partsAt([](const Body &body) {
          const auto &maxInfluence = body.rest().maxInfluence;
          return std::max_element(maxInfluence.begin(), maxInfluence.end()) - maxInfluence.begin();
        }) > 0);
}
