// SPDX-License-Identifier: Apache-2.0
// Spheres and capsules on a path: their surfaces, their motion, and the reaction of tissue.
#include <cmath>
#include <numbers>
#include <random>

#include "contact_cases.h"
#include "pointbased/probe_tool.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using namespace shapes;

namespace {

constexpr double kE = 1e4;  // Pa

ProbeTool sphere(double radius, const Vec3 &from, const Vec3 &to, double time = 1.0) {
  return {"finger", radius, 0.0, 0.3, {{0.0, from}, {time, to}}};
}

std::string problemOf(const ProbeTool &tool) {
  const auto built = obstacleOf(tool);
  return built ? std::string() : built.error();
}

SurfacePoint closestOf(const Obstacle &obstacle, const Vec3 &x) {
  SurfacePoint out;
  const double range = std::numeric_limits<double>::infinity();
  obstacle.closest(std::span(&x, 1), std::span(&range, 1), std::span(&out, 1));
  return out;
}

// A block that is fixed to the ground.
std::unique_ptr<Body> fixedBlock(const Vec3 &half, double height, LatticeSampling sampling, double viscosity = 0.0,
                                 int squares = 8) {
  const BodyShape shape = box(Vec3(-half[0], 0, -half[2]), Vec3(half[0], height, half[2]), squares);
  return shapes::makeBody(
      shapes::restState(shape, {.sampling = std::move(sampling),
                                .fixes = {{.region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitY()}}}}),
      {rubber(kE, viscosity)});
}

LatticeSampling cellsOf(double spacing) { return LatticeSampling{.spacing = spacing}; }

// N, on a tool.
struct Touch {
  Vec3 force = Vec3::Zero();
  double depth = 0.0, pressing = 0.0;
};
Touch touchOf(const Simulator &simulator, std::size_t tool) {
  Touch touch;
  for (const ContactSummary &c : simulator.diagnostics().contacts()) {
    if (c.second != tool) continue;
    touch.force -= c.force;
    touch.pressing += c.normalForce;
    touch.depth = std::max(touch.depth, c.depth);
  }
  return touch;
}

}  // namespace

TEST_CASE("the surface of a sphere and of a capsule is where its formula says, from all sides") {
  const double length = GENERATE(0.0, 0.03);
  const double radius = 0.01;
  const Vec3 middle(0.1, -0.2, 0.3), axis = Vec3(1, 2, -1).normalized();
  CAPTURE(length);
  const Obstacle tool =
      *obstacleOf({"tool", radius, length, 0.3, {{0.0, middle, 3.0 * axis}, {1.0, middle, 3.0 * axis}}});
  const auto distance = [&](const Vec3 &x) {
    double nearest = std::numeric_limits<double>::infinity();  // along the line, densely
    for (int k = -2000; k <= 2000; ++k)
      nearest = std::min(nearest, (x - middle - 0.5 * length * k / 2000.0 * axis).norm());
    return nearest - radius;
  };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> spread(-0.03, 0.03);
  const auto somewhere = [&] { return Vec3(middle + Vec3(spread(random), spread(random), spread(random))); };
  int inside = 0, met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = somewhere(), y = somewhere();
    const SurfacePoint near = closestOf(tool, x);
    CHECK(std::abs(near.distance - distance(x)) < 1e-7);
    CHECK(std::abs(near.normal.norm() - 1.0) < 1e-12);
    CHECK(std::abs(distance(x - near.distance * near.normal)) < 1e-7);
    inside += near.distance < 0.0 ? 1 : 0;
    // The first change of sign along the path.
    double first = -1.0;
    for (int k = 0; k < 1000 && first < 0.0; ++k)
      if ((closestOf(tool, x + k / 1000.0 * (y - x)).distance < 0.0) !=
          (closestOf(tool, x + (k + 1) / 1000.0 * (y - x)).distance < 0.0))
        first = (k + 0.5) / 1000.0;
    Vec3 normal = Vec3::Zero();
    const double t = tool.crossing(x, y, normal);
    if (first < 0.0) {
      // The loop misses grazing contact within a thousandth of the path.
      if (t >= 0.0) CHECK(distance(x + t * (y - x)) > -1e-6);
      continue;
    }
    ++met;
    CHECK(std::abs(t - first) < 0.001);
    CHECK(std::abs(normal.dot(closestOf(tool, x + t * (y - x)).normal)) > 1.0 - 1e-9);
  }
  CHECK(inside > 2);
  CHECK(met > 30);
  // Along its axis, and where the outward direction is undefined.
  Vec3 normal;
  const double t = tool.crossing(middle - 0.1 * axis, middle + 0.1 * axis, normal);
  CHECK_THAT(t, WithinRel((0.1 - radius - 0.5 * length) / 0.2, 1e-9));
  CHECK(std::abs(normal.dot(axis)) > 1.0 - 1e-9);
  CHECK(std::abs(closestOf(tool, middle).normal.norm() - 1.0) < 1e-12);
  CHECK(closestOf(tool, middle).distance == -radius);
}

TEST_CASE("a tool goes evenly from place to place, turns the shorter way and stands still before and after") {
  const Vec3 a(0.1, 0, 0), b(0.1, 0.2, 0), c(0.5, 0.2, 0);
  const Obstacle tool = *obstacleOf(
      {"tool", 0.01, 0.04, 0.3, {{1.0, a, Vec3::UnitX()}, {2.0, b, Vec3::UnitX()}, {4.0, c, 2.0 * Vec3::UnitY()}}});
  const auto at = [&](double t, const Vec3 &X) { return Vec3(X + tool.motion(t).displacementOf(X)); };
  const Vec3 end = a + 0.02 * Vec3::UnitX();  // of the line, at rest
  for (const double t : {-1.0, 0.0, 1.0}) {
    CHECK((at(t, a) - a).norm() < 1e-15);
    CHECK((at(t, end) - end).norm() < 1e-15);
  }
  CHECK((at(1.5, a) - Vec3(0.1, 0.1, 0)).norm() < 1e-15);
  CHECK((at(1.5, end) - Vec3(0.12, 0.1, 0)).norm() < 1e-15);
  CHECK((at(3.0, a) - Vec3(0.3, 0.2, 0)).norm() < 1e-15);
  CHECK((at(3.0, end) - Vec3(0.3 + 0.02 * std::sqrt(0.5), 0.2 + 0.02 * std::sqrt(0.5), 0)).norm() < 1e-15);
  for (const double t : {4.0, 5.0, 1e6}) CHECK((at(t, end) - Vec3(0.5, 0.22, 0)).norm() < 1e-15);
}

TEST_CASE("a tool that cannot be is refused with what is accepted") {
  ProbeTool tool = sphere(0.01, Vec3::Zero(), Vec3::UnitX());
  CHECK(problemOf(tool).empty());
  const auto with = [&](auto &&change) {
    ProbeTool changed = tool;
    change(changed);
    return problemOf(changed);
  };
  CHECK_THAT(with([](ProbeTool &t) { t.radius = 0.0; }), Contains("'finger': its radius is 0 mm; accepted"));
  CHECK_THAT(with([](ProbeTool &t) { t.radius = -0.002; }), Contains("radius is -2 mm"));
  CHECK_THAT(with([](ProbeTool &t) { t.length = NAN; }), Contains("length"));
  CHECK_THAT(with([](ProbeTool &t) { t.friction = -1.0; }), Contains("friction is -1"));
  CHECK_THAT(with([](ProbeTool &t) { t.path.pop_back(); }), Contains("1 places"));
  CHECK_THAT(with([](ProbeTool &t) { t.path[1].time = 0.0; }), Contains("times that ascend"));
  CHECK_THAT(with([](ProbeTool &t) { t.path[1].at[2] = INFINITY; }), Contains("place 1 of its path is not finite"));
  CHECK_THAT(with([](ProbeTool &t) { t.path[1].axis.setZero(); }), Contains("has no axis"));
  const auto turned = [](ProbeTool &t) { t.path[1].axis = -t.path[0].axis; };
  CHECK(with(turned).empty());  // a sphere
  tool.length = 0.01;
  CHECK_THAT(with(turned), Contains("180 degrees"));
}

TEST_CASE("Hertz: the force on a sphere that is pressed into a block") {
  // On a bonded block of finite height h Hertz's force times 1 - 2 α0 χ/π + …, χ = sqrt(R d)/h (Dimitriadis et
  // al., Biophys. J. 82, 2002); the sides, seven contact radii away, are not in it. Cells of 1.25 mm on a contact
  // radius of 4.9 mm, the penalty and the depth of 2 % of the radius leave a few per cent.
  const double R = 0.04, depth = 0.0006, half = 0.035, height = 0.03, nu = 0.3, pi = std::numbers::pi;
  LatticeSampling sampling = cellsOf(0.005);
  sampling.refinements.push_back({SphereRegion{Vec3(0, height, 0), 0.008}, 0.00125});
  Simulator simulator;
  simulator.setWorld({.integrator = Integrator::quasiStatic, .loadSteps = 2});
  const std::size_t id = simulator.addBody(fixedBlock(Vec3::Constant(half), height, sampling));
  ProbeTool tool = sphere(R, Vec3(0, height + R, 0), Vec3(0, height + R - depth, 0));
  tool.friction = 0.0;
  const std::size_t ball = simulator.addObstacle(*obstacleOf(tool));
  while (!simulator.finished()) REQUIRE(simulator.step());
  const double chi = std::sqrt(R * depth) / height;
  const double a0 = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu), q = a0 / pi;
  const double b0 = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  const double layer = 1 - 2 * q * chi + 4 * q * q * chi * chi -
                       8 / (pi * pi * pi) * (a0 * a0 * a0 + 4 * pi * pi / 15 * b0) * std::pow(chi, 3) +
                       16 * a0 / std::pow(pi, 4) * (a0 * a0 * a0 + 3 * pi * pi / 5 * b0) * std::pow(chi, 4);
  const double hertz = 4.0 / 3.0 * kE / (1 - nu * nu) * std::sqrt(R) * std::pow(depth, 1.5) * layer;
  const Touch touch = touchOf(simulator, ball);
  CHECK_THAT(touch.force[1], WithinRel(hertz, 0.05));
  CHECK(std::hypot(touch.force[0], touch.force[2]) < 1e-3 * hertz);
  CHECK(touch.depth < 0.05 * depth);
  // The pressing force is balanced at the base.
  const std::vector<Reaction> reactions = simulator.diagnostics().reactions(id);
  REQUIRE(reactions.size() == 1);
  CHECK((reactions[0].force - touch.force).norm() < 0.01 * hertz);
}

TEST_CASE(
    "a tool is pushed back with the same force in explicit, implicit and static solutions, and as by the ground") {
  // 0.4 mm/s, and then a pause until the oscillation decays.
  const Vec3 from(0, 0.051, 0), to(0.002, 0.048, 0);
  const double friction = GENERATE(0.0, 0.3);
  CAPTURE(friction);
  std::vector<Vec3> forces;
  double staticDepth = 0.0;  // m
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::implicitMidpoint, Integrator::backwardEuler,
        Integrator::quasiStatic}) {
    CAPTURE(static_cast<int>(integrator));
    const bool isStatic = integrator == Integrator::quasiStatic;
    Simulator simulator;
    simulator.setWorld({.integrator = integrator,
                        .dt = integrator == Integrator::explicitVerlet || isStatic ? 0.0 : 0.005,
                        .damping = isStatic ? 0.0 : 20.0,
                        .loadSteps = 20});
    const std::size_t id =
        simulator.addBody(fixedBlock(Vec3::Constant(0.03), 0.03, cellsOf(0.006), isStatic ? 0.0 : 20.0));
    ProbeTool tool = sphere(0.02, from, to, isStatic ? 1.0 : 0.4);
    tool.friction = friction;
    const std::size_t finger = simulator.addObstacle(*obstacleOf(tool));
    if (isStatic)
      while (!simulator.finished()) REQUIRE(simulator.step());
    else
      while (simulator.time() < 0.8) REQUIRE(simulator.step());
    const Touch touch = touchOf(simulator, finger);
    forces.push_back(touch.force);
    staticDepth = touch.depth;  // the static one is the last
    const std::vector<Reaction> reactions = simulator.diagnostics().reactions(id);
    REQUIRE(reactions.size() == 1);
    CHECK((reactions[0].force - touch.force).norm() < 0.02 * touch.force.norm());
    // It also moves sideways, where the block resists, more strongly with friction.
    CHECK(touch.force[0] < 0.0);
  }
  // Impulses hold a point at the surface, the penalty lets it in: force is proportional to depth^1.5.
  const double given = 1.0 + 1.5 * staticDepth / 0.002;
  CHECK(staticDepth < 0.0002);
  CHECK((forces.front() / given - forces.back()).norm() < 0.04 * forces.back().norm());
  for (std::size_t k = 1; k < forces.size(); ++k)
    CHECK((forces[k] - forces.back()).norm() < 0.04 * forces.back().norm());
}

TEST_CASE("a capsule that turns sweeps a body aside, and what it gives the body is what it gets") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld({.integrator = integrator, .dt = integrator == Integrator::explicitVerlet ? 0.0 : 1.0 / 240.0});
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(0.03, 0.005, -0.02), Vec3(0.07, 0.045, 0.02), 0.01, rubber(kE, 10.0)));
  // From 9 degrees below the block to 45 degrees, about its centre.
  const ProbeTool tool{
      "rod", 0.004, 0.16, 0.0, {{0.0, Vec3::Zero(), Vec3(1, -0.15, 0)}, {0.2, Vec3::Zero(), Vec3(1, 1, 0)}}};
  const std::size_t rod = simulator.addObstacle(*obstacleOf(tool));
  Vec3 impulse = Vec3::Zero();
  double deepest = 0.0;
  while (simulator.time() < 0.2) {
    const double then = simulator.time();
    REQUIRE(simulator.step());
    const Touch touch = touchOf(simulator, rod);
    impulse -= (simulator.time() - then) * touch.force;
    deepest = std::max(deepest, touch.depth);
  }
  const Body &body = *simulator.body(id);
  const Vec3 momentum = body.totalMass() * meanVelocity(body);
  CHECK(momentum[1] > 0.1 * body.totalMass());
  CHECK((impulse - momentum).norm() < (integrator == Integrator::explicitVerlet ? 1e-6 : 0.02) * momentum.norm());
  CHECK(deepest < 0.002);
}
