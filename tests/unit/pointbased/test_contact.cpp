// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

Obstacle ground(double height, double friction, int *asked = nullptr) {
  Obstacle o;
  o.name = "ground";
  o.friction = friction;
  o.closest = [=](std::span<const Vec3> points, std::span<const double> ranges, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = points[i][1] - height;
      if (asked) ++*asked;
      out[i] = {Vec3(0, 1, 0), d <= ranges[i] ? d : std::numeric_limits<double>::infinity()};
    }
  };
  o.crossing = [=](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    normal = Vec3(0, 1, 0);
    const double a = from[1] - height, b = to[1] - height;
    return a * b <= 0.0 && a != b ? a / (a - b) : -1.0;
  };
  return o;
}

/// A sheet without inside, 1 mm thick in no sense: only crossing and closest tell.
std::unique_ptr<Body> particle(const Vec3 &at, double spacing) {
  return std::make_unique<Body>("particle", shapes::restState(std::vector<Vec3>{at}, spacing), Material{}, 0.0, serialFor());
}

}  // namespace

TEST_CASE("a single phyxel falls freely as velocity Verlet says, then lies on the ground") {
  Simulator simulator;
  WorldSettings world;
  world.gravity = Vec3(0, -9.81, 0);
  world.dt = 1e-3;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(particle(Vec3(0, 0.5, 0), 0.01));
  simulator.addObstacle(ground(0.0, 0.3));
  for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
  // Constant acceleration is integrated without error.
  CHECK_THAT(simulator.body(id)->state().displacements[0][1], WithinRel(-0.5 * 9.81 * 0.04, 1e-12));
  for (int i = 0; i < 800; ++i) REQUIRE(simulator.step());
  CHECK_THAT(0.5 + simulator.body(id)->state().displacements[0][1], WithinAbs(0.005, 1e-5));  // its contact radius
  CHECK(simulator.body(id)->state().velocities[0].norm() < 1e-12);
}

TEST_CASE("a phyxel at 100 m/s does not pass a thin wall") {
  for (const double speed : {1.0, 10.0, 100.0}) {
    Simulator simulator;
    WorldSettings world;
    world.dt = 1e-3;
    simulator.setWorld(world);
    const std::size_t id = simulator.addBody(particle(Vec3(0, 0.5, 0), 0.01));
    simulator.addObstacle(ground(0.0, 0.3));
    simulator.body(id)->state().velocities[0] = Vec3(0, -speed, 0);
    double lowest = 1.0;
    for (int i = 0; i < 600; ++i) {
      REQUIRE(simulator.step());
      lowest = std::min(lowest, 0.5 + simulator.body(id)->state().displacements[0][1]);
    }
    CHECK(lowest > 0.0049);
    CHECK(lowest < 0.51 - 0.1);
  }
}

TEST_CASE("an obstacle far away is not asked at every step") {
  int asked = 0;
  Simulator simulator;
  WorldSettings world;
  world.dt = 1e-3;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(particle(Vec3(0, 10.0, 0), 0.01));
  simulator.addObstacle(ground(0.0, 0.3, &asked));
  simulator.body(id)->state().velocities[0] = Vec3(0, -1.0, 0);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulator.step());
  CHECK(asked < 20);
}

TEST_CASE("friction stops a sliding phyxel where Coulomb says") {
  Simulator simulator;
  WorldSettings world;
  world.gravity = Vec3(0, -9.81, 0);
  world.dt = 1e-3;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(particle(Vec3(0, 0.005, 0), 0.01));
  simulator.addObstacle(ground(0.0, 0.4));
  simulator.body(id)->state().velocities[0] = Vec3(1.0, 0, 0);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulator.step());
  CHECK(simulator.body(id)->state().velocities[0].norm() < 1e-12);
  // v²/(2 mu g); first order in dt at start and stop.
  CHECK_THAT(simulator.body(id)->state().displacements[0][0], WithinRel(1.0 / (2 * 0.4 * 9.81), 0.02));
}

TEST_CASE("a phyxel that starts inside is led out without being thrown") {
  Simulator simulator;
  WorldSettings world;
  world.gravity = Vec3(0, -9.81, 0);
  world.dt = 1e-3;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(particle(Vec3(0, -0.02, 0), 0.01));
  simulator.addObstacle(ground(0.0, 0.3));
  double highest = -1.0;
  for (int i = 0; i < 2000; ++i) {
    REQUIRE(simulator.step());
    highest = std::max(highest, -0.02 + simulator.body(id)->state().displacements[0][1]);
  }
  CHECK_THAT(-0.02 + simulator.body(id)->state().displacements[0][1], WithinAbs(0.005, 2e-4));
  CHECK(highest < 0.01);
}

TEST_CASE("the walls of the world box hold on all sides") {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Simulator simulator;
      WorldSettings world;
      world.dt = 1e-3;
      world.box.enabled = true;
      simulator.setWorld(world);
      const std::size_t id = simulator.addBody(particle(Vec3(0, 0, 0), 0.01));
      simulator.body(id)->state().velocities[0] = 30.0 * side * Vec3::Unit(axis);
      for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
      CHECK_THAT(simulator.body(id)->state().displacements[0][axis], WithinAbs(side * 0.995, 1e-6));
    }
}
