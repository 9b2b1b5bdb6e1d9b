// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "contact_cases.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

Obstacle ground(double friction, shapes::Asked *asked = nullptr) {
  return shapes::halfSpace(Vec3::Zero(), Vec3(0, 1, 0), friction, asked);
}

std::unique_ptr<Body> particle(const Vec3 &at, double spacing) {
  return std::make_unique<Body>("particle", shapes::restState(std::vector<Vec3>{at}, spacing), Constitution{},
                                serialFor());
}

}  // namespace

TEST_CASE("a single phyxel falls freely as velocity Verlet says, then lies on the ground") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .dt = 1e-3});
  const std::size_t id = simulator.addBody(particle(Vec3(0, 0.5, 0), 0.01));
  simulator.addObstacle(ground(0.3));
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
    simulator.setWorld({.dt = 1e-3});
    const std::size_t id = simulator.addBody(particle(Vec3(0, 0.5, 0), 0.01));
    simulator.addObstacle(ground(0.3));
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
  shapes::Asked asked;
  Simulator simulator;
  simulator.setWorld({.dt = 1e-3});
  const std::size_t id = simulator.addBody(particle(Vec3(0, 10.0, 0), 0.01));
  simulator.addObstacle(ground(0.3, &asked));
  simulator.body(id)->state().velocities[0] = Vec3(0, -1.0, 0);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulator.step());
  CHECK(asked.closest < 20);
}

TEST_CASE("friction stops a sliding phyxel where Coulomb says") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .dt = 1e-3});
  const std::size_t id = simulator.addBody(particle(Vec3(0, 0.005, 0), 0.01));
  simulator.addObstacle(ground(0.4));
  simulator.body(id)->state().velocities[0] = Vec3(1.0, 0, 0);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulator.step());
  CHECK(simulator.body(id)->state().velocities[0].norm() < 1e-12);
  // v²/(2 mu g); first order in dt at start and stop.
  CHECK_THAT(simulator.body(id)->state().displacements[0][0], WithinRel(1.0 / (2 * 0.4 * 9.81), 0.02));
}

TEST_CASE("a phyxel that starts inside is led out without being thrown") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .dt = 1e-3});
  const std::size_t id = simulator.addBody(particle(Vec3(0, -0.02, 0), 0.01));
  simulator.addObstacle(ground(0.3));
  double highest = -1.0;
  for (int i = 0; i < 2000; ++i) {
    const auto stepped = simulator.step();
    INFO((stepped ? std::string() : stepped.error().text) << " at step " << i);
    REQUIRE(stepped);
    highest = std::max(highest, -0.02 + simulator.body(id)->state().displacements[0][1]);
  }
  CHECK_THAT(-0.02 + simulator.body(id)->state().displacements[0][1], WithinAbs(0.005, 2e-4));
  CHECK(highest < 0.01);
}

TEST_CASE("the walls of the world box hold on all sides") {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Simulator simulator;
      simulator.setWorld({.box = {.enabled = true}, .dt = 1e-3});
      const std::size_t id = simulator.addBody(particle(Vec3(0, 0, 0), 0.01));
      simulator.body(id)->state().velocities[0] = 30.0 * side * Vec3::Unit(axis);
      for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
      CHECK_THAT(simulator.body(id)->state().displacements[0][axis], WithinAbs(side * 0.995, 1e-6));
    }
}

TEST_CASE("a point that has come through a sheet is led back to the side it came from") {
  const Obstacle obstacle = shapes::sheet(0.0, 1.0, 0.3);
  ContactState memory;
  Vec3 x(0.1, 0.01, 0.2), v(0, -1, 0);
  const auto find = [&] {
    findContacts({&obstacle, 1}, WorldBox{}, 0.0, 1e-3, 2e-4, {&x, 1}, {&v, 1}, {}, memory, serialFor());
  };
  find();
  CHECK(memory.active.empty());
  // Pushed through by motion elsewhere in the body: a distance alone would give the wrong side.
  x = Vec3(0.11, -0.004, 0.2);
  for (int k = 0; k < 3; ++k) {
    find();
    REQUIRE(memory.active.size() == 1);
    CHECK_THAT(memory.active[0].gap, WithinAbs(x[1], 1e-12));
    CHECK_THAT(memory.active[0].normal[1], WithinAbs(1.0, 1e-12));
    x += Vec3(0.001, 0.0005, 0);
  }
}

TEST_CASE("a point that slides on the floor of an obstacle meets its wall") {
  // The inner corner of an L: floor y = 0, wall x = 0.
  Obstacle corner;
  corner.closest = [](std::span<const Vec3> points, std::span<const double>, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = points[i][0] < points[i][1] ? SurfacePoint{Vec3::UnitX(), points[i][0]}
                                           : SurfacePoint{Vec3::UnitY(), points[i][1]};
  };
  corner.crossing = [](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    double best = -1.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double a = from[axis], b = to[axis];
      if (a * b > 0.0 || a == b) continue;
      const double t = a / (a - b);
      if ((from + t * (to - from))[1 - axis] < 0.0 || (best >= 0.0 && t > best)) continue;
      best = t;
      normal = Vec3::Unit(axis);
    }
    return best;
  };
  ContactState memory;
  // Slightly below the floor, as for a body that rests on it.
  Vec3 x(0.0105, -1e-6, 0), v(-1, 0, 0);
  bool met = false;
  for (int k = 0; k < 20 && x[0] > 0.0; ++k) {
    findContacts({&corner, 1}, WorldBox{}, 0.0, 1e-3, 2e-4, {&x, 1}, {&v, 1}, {}, memory, serialFor());
    for (const Contact &contact : memory.active)
      if (contact.normal[0] > 0.9) {
        CHECK_THAT(contact.gap, WithinAbs(x[0], 1e-12));
        met = true;
      }
    if (!met)
      x += 1e-3 * v;
    else
      break;
  }
  CHECK(met);
  CHECK(x[0] > 0.0);
}

TEST_CASE("impulses add no kinetic energy, whatever they start from, and are the change of both momenta") {
  shapes::Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto body = shapes::latticeBox(Vec3(-0.03, 0, -0.03), Vec3(0.03, 0.06, 0.03), 0.02, shapes::rubber(1e4));
    const Interpolation &binding = body->rest().contact.binding;
    std::vector<Vec3> v(body->masses().size());
    for (Vec3 &one : v) one = random.vector();
    ContactState memory;
    memory.margin = 4e-4;
    for (std::size_t p = 0; p < binding.count(); p += 2) {
      Contact contact;
      contact.point = static_cast<Index>(p);
      contact.normal = random.vector().normalized();
      contact.gap = std::max(0.0, 1e-3 * random());
      contact.friction = 0.4;
      contact.normalImpulse = contact.projectionImpulse = std::max(0.0, 0.05 * random());
      memory.active.push_back(contact);
    }
    const auto kinetic = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < v.size(); ++i) sum += 0.5 * body->masses()[i] * v[i].squaredNorm();
      return sum;
    };
    const auto momenta = [&] {
      Vec3 p = Vec3::Zero(), l = Vec3::Zero();
      for (std::size_t i = 0; i < v.size(); ++i) {
        p += body->masses()[i] * v[i];
        l += body->rest().positions[i].cross(body->masses()[i] * v[i]);
      }
      return std::pair(p, l);
    };
    const double before = kinetic();
    const auto [p0, l0] = momenta();
    const Vec3 total = solveContactImpulses(binding, body->inverseMasses(), 1e-3, ImpulseSettings{}, memory, v);
    const double between = kinetic();
    CHECK(between < before);
    const auto [p1, l1] = momenta();
    CHECK((p1 - p0 - total).norm() < 1e-12 * (1.0 + total.norm()));
    Vec3 torque = Vec3::Zero();
    for (const Contact &contact : memory.active) {
      CHECK(contact.normalImpulse >= 0.0);
      CHECK(contact.frictionImpulse.norm() <= contact.friction * contact.normalImpulse * (1.0 + 1e-9) + 1e-15);
      torque +=
          binding.positions[contact.point].cross(contact.normalImpulse * contact.normal + contact.frictionImpulse);
    }
    CHECK((l1 - l0 - torque).norm() < 1e-12 * (1.0 + torque.norm()));
    projectContactVelocities(binding, body->inverseMasses(), 1e-3, memory, v);
    CHECK(kinetic() <= between);
  }
}

TEST_CASE("contact points carry the whole area of a skin and thin it to the spacing") {
  const Surface fine = shapes::boxSurface(Vec3::Zero(), Vec3(0.1, 0.08, 0.06), 40);
  const Surface coarse = shapes::boxSurface(Vec3::Zero(), Vec3(0.1, 0.08, 0.06), 1);
  for (const Surface *surface : {&fine, &coarse}) {
    const SurfacePoints points = chooseContactPoints(*surface, 0.02);
    CHECK_THAT(shapes::sum(points.areas), WithinRel(2.0 * (0.1 * 0.08 + 0.08 * 0.06 + 0.06 * 0.1), 1e-12));
    CHECK(points.count() < 600);  // one per (d/2)² of 376 such squares, and edges
    CHECK(points.count() > 300);
    for (const Vec3 &normal : points.normals) CHECK_THAT(normal.norm(), WithinAbs(1.0, 1e-12));
  }
}
