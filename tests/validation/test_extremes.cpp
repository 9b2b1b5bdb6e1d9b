// SPDX-License-Identifier: Apache-2.0
// Extremes of the material and of the step.
#include <cmath>
#include <functional>

#include "extreme_cases.h"
#include "pointbased/plasticity.h"
#include "solved_body.h"
#include "support/catch.h"

using namespace extremes;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

WorldSettings freeWorld(double dt = 0.0, Integrator integrator = Integrator::explicitVerlet) {
  return WorldSettings{.integrator = integrator, .dt = dt};
}

}  // namespace

TEST_CASE("Young's modulus from 1 Pa to 20 GPa: a stable step or a report, implicit below the floor") {
  std::string result;
  for (const double youngs : {1.0, 1e3, 1e6, 1e9, 2e10}) {
    CAPTURE(youngs);
    Simulator simulator;
    WorldSettings world = freeWorld();
    world.gravity = Vec3(0, -9.81, 0);
    simulator.setWorld(world);
    const std::size_t id = simulator.addBody(cube(rubber(youngs), 0.01, 0.002));
    simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
    Body &body = *simulator.body(id);
    body.setInitialVelocity(Vec3(0, -1, 0), Vec3::Zero());
    const double stable = kStepSafety * body.stableStepAtRest();
    const bool stiff = stable < kSmallestExplicitStep;
    CHECK(stiff == (youngs > 1.5e10));
    CHECK_THAT(simulator.stepper().stepSize(), WithinRel(stiff ? kImplicitStep : stable, 1e-12));
    bool good = true;
    for (int i = 0; i < (stiff ? 30 : 300) && good; ++i) good = simulator.step().has_value();
    CHECK(finite(body));
    CHECK(good == !body.stopped);
    CHECK(told(simulator, "switched") == stiff);
    if (youngs >= 1e3) CHECK(good);
    result += (result.empty() ? "" : "; ") + text(youngs) + " Pa: " + (stiff ? "implicit, " : "explicit, ") +
              text(simulator.stepper().stepSize()) + " s, " + (good ? "finite" : "stopped with a report");
  }
  row("E from 1 Pa to 20 GPa", result);
}

TEST_CASE("k times the modulus is the same motion, sqrt(k) times as fast") {
  std::vector<Vec3> reference;
  double worst = 0.0;
  for (const double k : {1.0, 4.0, 1e4, 2e10}) {
    CAPTURE(k);
    Simulator simulator;
    const std::size_t id = simulator.addBody(cube(rubber(1.0 * k), 0.01));
    Body &body = *simulator.body(id);
    WorldSettings world = freeWorld(kStepSafety * body.stableStepAtRest());
    world.gravity = k * Vec3(0, -0.005, 0);
    simulator.setWorld(world);
    simulator.addObstacle(shapes::halfSpace(Vec3(0, -1e-5, 0), Vec3::UnitY(), 0.3));
    body.setInitialVelocity(Vec3::Zero(), std::sqrt(k) * Vec3(0.2, 0.1, 0.3));
    for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
    if (reference.empty()) {
      reference = body.state().displacements;
      continue;
    }
    // The step itself is the same only up to round-off, which contact and 200 steps propagate.
    const double error = difference(body.state().displacements, reference);
    worst = std::max(worst, error);
    CHECK(error < 1e-8);
  }
  row("E → kE, t → t/√k", "k up to 2e10, shapes after 200 steps with contact: " + text(worst) + " apart");
}

TEST_CASE("moduli that are no moduli are refused with the value and what is accepted") {
  for (const double youngs : {0.0, -1.0, kNaN, kInfinity}) {
    const auto answer = validate(rubber(youngs));
    REQUIRE_FALSE(answer);
    CHECK_THAT(answer.error(), Contains("Young's modulus"));
  }
  row("E = 0, negative, NaN, infinite", "refused: " + validate(rubber(-1.0)).error());
  for (const double poisson : {-1.0, 0.5, 0.6, -2.0, kNaN}) {
    const auto answer = validate(rubber(1e3, poisson));
    REQUIRE_FALSE(answer);
    CHECK_THAT(answer.error(), Contains("Poisson's ratio"));
  }
  for (const double poisson : {-0.999, 0.0, 0.4999}) CHECK(validate(rubber(1e3, poisson)));
  row("ν <= -1 or >= 0.5", "refused: " + validate(rubber(1e3, 0.5)).error());
}

namespace {

// Falls 1 mm on the ground and bounces for 0.1 s.
void drop(std::initializer_list<double> ratios, const std::string &name) {
  std::string result;
  bool all = true;
  for (const double poisson : ratios) {
    CAPTURE(poisson);
    Simulator simulator;
    WorldSettings world = freeWorld();
    world.gravity = Vec3(0, -9.81, 0);
    simulator.setWorld(world);
    const std::size_t id = simulator.addBody(cube(rubber(1e4, poisson), 0.01, 0.001));
    simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
    const double before = shapes::totalEnergy(simulator, id);
    double most = before;
    bool good = true;
    while (simulator.time() < 0.1 && good) {
      good = simulator.step().has_value();
      most = std::max(most, shapes::totalEnergy(simulator, id));
    }
    CHECK(finite(*simulator.body(id)));
    CHECK(good);
    // The scale is the work of gravity: m g times about 4 mm; velocity Verlet oscillates by a part of that.
    CHECK(most - before < 0.05 * 0.064 * 9.81 * 0.004);
    all = all && good;
    result += (result.empty() ? "" : "; ") + text(poisson) + ": " + text(1e6 * simulator.stepper().stepSize()) + " µs" +
              (good ? "" : ", stopped after " + text(simulator.time()) + " s: " + simulator.body(id)->stopMessage());
  }
  row(name, (all ? "finite, energy does not grow; steps " : "not met: ") + result);
}

}  // namespace

TEST_CASE("Poisson's ratio from -0.5 to 0.4999: the step adapts and the body stays finite") {
  drop({-0.5, 0.0, 0.3, 0.45, 0.49, 0.499, 0.4999}, "ν from -0.5 to 0.4999");
}

// lambda < 0: lambda/2 (ln J)² would attract where the compression exceeds 4 %; the law for nu < 0 has another term.
TEST_CASE("bodies with Poisson's ratios of -0.9 and -0.99 land as others do") {
  drop({-0.9, -0.99}, "ν = -0.9, -0.99");
}

TEST_CASE("at a Poisson's ratio of 0.4999 a beam keeps its volume and bends as at 0.49") {
  // Timoshenko with kappa = 10 (1 + nu) / (12 + 11 nu); slender, so that the clamp's own stiffening stays below 1 %.
  const double length = 0.4, height = 0.04, youngs = 1e5, force = -0.02;
  const auto solve = [&](double poisson) {
    validation::Problem problem =
        validation::Problem::rubber(shapes::box(Vec3::Zero(), Vec3(length, height, height)), 0.01);
    problem.shape.surface = shapes::boxSurface(Vec3::Zero(), Vec3(length, height, height), 8);
    problem.material = rubber(youngs, poisson);
    problem.hold(validation::face(0, 0.0)).pull(validation::face(0, length), Vec3(0, force, 0));
    auto solved = std::make_unique<validation::SolvedBody>(problem);
    REQUIRE_FALSE(solved->body().stopped);
    const double area = height * height, moment = area * area / 12.0, shear = youngs / (2.0 * (1.0 + poisson));
    const double kappa = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    const double truth = force * (std::pow(length, 3) / (3.0 * youngs * moment) + length / (kappa * shear * area));
    const double error = solved->meanOver(validation::face(0, length))[1] / truth - 1.0;
    return std::pair(error, volumeError(solved->body()));
  };
  const auto [usual, usualVolume] = solve(0.49);
  const auto [extreme, volume] = solve(0.4999);
  CAPTURE(usual, extreme, volume.total, volume.local);
  CHECK(volume.total < 0.01);
  CHECK(volume.local < 0.01);
  CHECK(std::abs(extreme) < 2.0 * std::abs(usual));
  row("ν = 0.4999: locking",
      "bending " + text(100.0 * extreme) + " % off Timoshenko's beam (ν = 0.49: " + text(100.0 * usual) +
          " %), volume " + text(100.0 * volume.total) + " %, of a point at most " + text(100.0 * volume.local) + " %");
}

TEST_CASE("steps of no size, of negative size and of no number are chosen by the program") {
  for (const double dt : {0.0, -0.0, -1.0, -kInfinity, kNaN}) {
    CAPTURE(dt);
    Simulator simulator;
    simulator.setWorld(freeWorld(dt));
    const std::size_t id = simulator.addBody(cube(rubber(1e4)));
    CHECK(simulator.stepper().stepSize() == kStepSafety * simulator.body(id)->stableStepAtRest());
    REQUIRE(simulator.step());
    CHECK(simulator.time() > 0.0);
  }
  row("dt = 0, negative, NaN", "means automatic: 0.8 of the stable step");
}

TEST_CASE(
    "steps that are far too large are divided, and end early where that is too much, implicit ones stop with a "
    "report") {
  std::string result;
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler})
    for (const double dt : {0.1, 1.0, 1e3, 1e9, 1e300}) {
      CAPTURE(dt, static_cast<int>(integrator));
      Simulator simulator;
      WorldSettings world = freeWorld(dt, integrator);
      world.gravity = Vec3(0, -9.81, 0);
      simulator.setWorld(world);
      const std::size_t id = simulator.addBody(cube(rubber(1e4), 0.02, 0.01));
      simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
      bool good = true;
      for (int i = 0; i < 3 && good; ++i) good = simulator.step().has_value();
      CHECK(finite(*simulator.body(id)));
      CHECK(std::isfinite(simulator.time()));
      CHECK(good == !simulator.body(id)->stopped);
      if (integrator == Integrator::explicitVerlet) {
        // 10 000 substeps are the limit of a step, which then ends early: the clock reports its progress.
        CHECK(good);
        CHECK(told(simulator, "substep"));
        CHECK(told(simulator, "slowed") == (dt > 1.0));
        CHECK(simulator.time() > 0.1);
        if (dt <= 1.0)
          CHECK_THAT(simulator.time(), WithinRel(3.0 * dt, 1e-9));
        else
          CHECK(simulator.time() < dt);
      } else if (dt <= 1.0) {
        CHECK(good);
      }
      result += (result.empty() ? "" : ", ") + text(dt) + " s " +
                (integrator == Integrator::explicitVerlet  ? "explicit: "
                 : integrator == Integrator::implicitSdirk ? "implicit: "
                                                           : "backward Euler: ") +
                (!good                       ? "stopped"
                 : told(simulator, "slowed") ? "slowed to " + text(simulator.time() / 3.0) + " s"
                                             : "finite");
    }
  row("dt huge", result);
}

TEST_CASE("a step that ends early ends at the same time for all bodies") {
  // The second step advances less and reverts the first one; the third one would advance farther.
  Simulator simulator;
  WorldSettings world = freeWorld(1e3);
  world.gravity = Vec3(0, -9.81, 0);
  simulator.setWorld(world);
  simulator.world().setContact({false, false, 0.0});  // they overlap
  std::vector<std::size_t> ids;
  for (const double youngs : {1e4, 1e6, 1e3}) ids.push_back(simulator.addBody(cube(rubber(youngs))));
  const double least = kStepSafety * simulator.body(ids[1])->stableStepAtRest();
  for (int i = 1; i <= 2; ++i) {
    REQUIRE(simulator.step());
    CHECK(told(simulator, "slowed"));
    const double t = simulator.time();
    CHECK_THAT(t, WithinRel(i * 1e4 * least, 1e-4));  // even parts of the step, a little shorter than the largest
    // In free fall, the displacement indicates every body's own time.
    for (const std::size_t id : ids)
      for (const Vec3 &u : simulator.body(id)->state().displacements)
        CHECK_THAT(u[1], WithinRel(-0.5 * 9.81 * t * t, 1e-9));
  }
  row("steps of 1000 s, three bodies, E = 10 kPa, 1 MPa, 1 kPa",
      "all end after 10 000 substeps of the stiffest, at " + text(simulator.time() / 2.0) + " s a step");
}

TEST_CASE("an infinite step is refused or chosen by the program") {
  std::string result;
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    Simulator simulator;
    simulator.setWorld(freeWorld(kInfinity, integrator));
    (void)simulator.addBody(cube(rubber(1e4)));
    const bool good = simulator.step().has_value();
    CHECK(std::isfinite(simulator.time()));
    result += std::string(integrator == Integrator::explicitVerlet ? "explicit" : "; implicit") + ": " +
              (good ? "step done" : "stopped with a report") + ", time " + text(simulator.time()) + " s";
  }
  row("dt infinite", result);
}

// Verlet is symplectic at one step size only. With alternating sizes it resonates (the energy grew by 180 % with steps
// of up to 0.8 of the stable one), so the program uses smaller steps while the caller changes them.
TEST_CASE("step sizes that change at every step do not pump energy") {
  shapes::Random random(3);
  double most = 1.0, least = 1.0;
  const auto swing = [&](double spacing, int steps, const std::function<double(int, double)> &size) {
    Simulator simulator;
    const std::size_t id = simulator.addBody(cube(rubber(1e4), spacing));
    Body &body = *simulator.body(id);
    body.setInitialVelocity(Vec3(0.1, 0, 0), Vec3(3, 2, 1));
    displace(body, Vec3(1.1, 1.0, 0.95).asDiagonal());
    body.computeGradients(serialFor());
    const double before = shapes::totalEnergy(simulator, id), automatic = simulator.stepper().stepSize();
    for (int i = 0; i < steps; ++i) {
      simulator.setWorld(freeWorld(size(i, automatic)));
      REQUIRE(simulator.step());
      most = std::max(most, shapes::totalEnergy(simulator, id) / before);
      least = std::min(least, shapes::totalEnergy(simulator, id) / before);
    }
  };
  const double sizes[] = {1e-6, 1e-2, 3e-5, 1e-3, 1e-9, 2e-3};
  swing(0.005, 120, [&](int i, double) { return sizes[i % 6]; });
  swing(0.01, 600, [&](int i, double) { return sizes[i % 6]; });
  swing(0.01, 1000, [](int i, double a) { return i % 2 ? a : 0.5 * a; });
  swing(0.01, 1000, [](int i, double a) { return i % 2 ? 0.99 * a : 1e-3 * a; });
  swing(0.01, 1000, [](int i, double a) { return i % 3 ? 0.8 * a : 0.3 * a; });
  swing(0.01, 1000, [&](int, double a) { return a * (0.51 + 0.49 * random()); });
  // At a fifth of the stable step at most, (omega dt)²/4 is 4 % of the share of the fastest modes, which each change
  // may add or remove; a part of it remains.
  CHECK(most < 1.04);
  CHECK(least > 0.9);
  row("dt variable: 1 ns to 10 ms in turn, pairs of the automatic one, at random",
      "600 … 1000 steps: energy " + text(100.0 * (least - 1.0)) + " … +" + text(100.0 * (most - 1.0)) + " %");
}

// As the body oscillates, a step just below the automatic one is sometimes whole, sometimes halved.
TEST_CASE("steps just below the stable one keep the energy") {
  double worst = 1.0, at = 0.0;
  for (const double part : {0.8, 0.85, 0.9, 0.92, 0.94, 0.9465, 0.95, 0.96, 0.98, 1.0}) {
    Simulator simulator;
    const std::size_t id = simulator.addBody(cube(rubber(1e4), 0.01));
    Body &body = *simulator.body(id);
    body.setInitialVelocity(Vec3(0.1, 0, 0), Vec3(3, 2, 1));
    displace(body, Vec3(1.1, 1.0, 0.95).asDiagonal());
    body.computeGradients(serialFor());
    const double before = shapes::totalEnergy(simulator, id);
    simulator.setWorld(freeWorld(part * kStepSafety * body.stableStepAtRest()));
    double most = 1.0;
    while (simulator.time() < 1.0) {
      REQUIRE(simulator.step());
      most = std::max(most, shapes::totalEnergy(simulator, id) / before);
    }
    CAPTURE(part);
    CHECK(most < 1.05);  // velocity Verlet: (omega dt)²/4 of the fastest modes' small share
    if (most > worst) {
      worst = most;
      at = part;
    }
  }
  row("dt 0.8 … 1 of the automatic one, 1 s of free swinging",
      "energy at most " + text(worst) + " of the first, at " + text(at) + " of the automatic step");
}

TEST_CASE("neighbours with a million times the stiffness or mass: momenta are kept, the interface stays closed") {
  std::string result;
  struct Pair {
    const char *name;
    double youngs, density;
  };
  for (const Pair &pair :
       {Pair{"E", 1e6, 1.0}, Pair{"density", 1.0, 1e6}, Pair{"both", 1e6, 1e6}, Pair{"opposed", 1e6, 1e-6}}) {
    CAPTURE(pair.name);
    BodyShape shape = shapes::box(Vec3::Zero(), Vec3(0.08, kEdge, kEdge));
    const auto rest = shapes::restState(
        shape, {.sampling = {.spacing = 0.01, .materials = {{BoxRegion{Vec3(0.04, -1, -1), Vec3(1, 1, 1)}, 1}}}});
    Material first = rubber(10.0), second = rubber(10.0 * pair.youngs);
    second.restDensity = first.restDensity * pair.density;
    Simulator simulator;
    const std::size_t id = simulator.addBody(shapes::makeBody(rest, {first, second}, "pair"));
    Body &body = *simulator.body(id);
    // Slow relative to the slower wave, so that inertia tears nothing apart.
    const double wave =
        std::sqrt(std::min(first.youngsModulus / first.restDensity, second.youngsModulus / second.restDensity));
    body.setInitialVelocity(wave * Vec3(0.1, 0.2, 0), wave / 0.08 * Vec3(0.2, 0.1, 0.1));
    displace(body, Vec3(1.02, 1.0, 0.99).asDiagonal());
    simulator.setWorld(freeWorld(kStepSafety * body.stableStepAtRest()));
    const Momenta before = momenta(body);
    for (int i = 0; i < 1000; ++i) REQUIRE(simulator.step());
    const Momenta after = momenta(body);
    const double drift = (after.linear - before.linear).norm() / after.size;
    // Impulses of 1000 steps, each with its round-off; momenta of the parts are larger than their sum.
    CHECK(finite(body));
    CHECK(drift < 1e-12);
    CHECK((after.angular - before.angular).norm() < 1e-12 * after.size * 0.08);
    // Points a millionth of a millimetre on both sides.
    std::vector<Vec3> points;
    for (const double y : {0.003, 0.02, 0.037})
      for (const double side : {-1e-9, 1e-9}) points.push_back(Vec3(0.04 + side, y, 0.5 * y) - body.rest().origin);
    const Interpolation bound = body.rest().bind(points, {});
    std::vector<Vec3> u(points.size());
    interpolateDisplacements(bound, body.rest().positions, body.state().displacements, u, serialFor());
    double jump = 0.0;
    for (std::size_t p = 0; p < u.size(); p += 2) jump = std::max(jump, (u[p] - u[p + 1]).norm());
    CHECK(jump < 1e-6 * largest(body.state().displacements));
    result += (result.empty() ? "" : "; ") + std::string(pair.name) + ": momentum " + text(drift) + ", jump " +
              text(jump) + " m";
  }
  row("E or density ratio 1e6 between neighbours", "1000 steps, " + result);
}

TEST_CASE("plastic limits: without flow bitwise elastic, with all of it nothing pulls back, volume is kept, any step") {
  const auto thrown = [](const Plasticity &plastic) {
    Simulator simulator;
    WorldSettings world = freeWorld();
    world.gravity = Vec3(0, -9.81, 0);
    simulator.setWorld(world);
    Material material = rubber(5e3);
    material.plastic = plastic;
    const std::size_t id = simulator.addBody(cube(material, 0.02, 0.002));
    simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
    simulator.body(id)->setInitialVelocity(Vec3(0, -1.0, 0), Vec3::Zero());
    for (int i = 0; i < 300; ++i)
      if (!simulator.step()) break;
    CHECK_FALSE(simulator.body(id)->stopped);
    double volume = 0.0;
    for (const Mat3 &F : simulator.body(id)->state().history.plasticInverse)
      volume = std::max(volume, std::abs(F.determinant() - 1.0));
    return std::pair(simulator.stateHash(), volume);
  };
  const std::uint64_t elastic = thrown({}).first;
  CHECK(thrown({Plasticity::kNever, 1.0, 0.01, Plasticity::kNever}).first == elastic);
  CHECK(thrown({0.0, 1.0, 0.01, 0.0}).first == elastic);
  CHECK(thrown({0.0, 0.0, 0.01, Plasticity::kNever}).first == elastic);
  const auto [flowing, volume] = thrown({0.0, 1.0, 0.01, Plasticity::kNever});
  CHECK(flowing != elastic);
  CHECK(volume < 1e-12);

  Material melts = rubber(5e3);
  melts.plastic = {0.0, 1.0, 0.01, Plasticity::kNever};
  auto body = cube(melts);
  const double s = 1.3;
  displace(*body, Vec3(s, 1.0 / std::sqrt(s), 1.0 / std::sqrt(s)).asDiagonal());
  shapes::evaluate(*body);
  const double before = body->elasticEnergy().strain, pull = largest(body->forces());
  body->computeFlow(1e-3, serialFor());
  shapes::evaluate(*body);
  CHECK(body->elasticEnergy().strain < 1e-12 * before);
  CHECK(largest(body->forces()) < 1e-9 * pull);

  // The rate form: 1 and 1000 steps over the same time at the same F.
  const Plasticity slow{0.05, 0.5, 0.01, Plasticity::kNever};
  Mat3 F = Mat3::Identity();
  F(0, 1) = 0.6;
  Mat3 once = Mat3::Identity(), often = Mat3::Identity();
  plasticFlow(slow, F, 0.02, once);
  for (int i = 0; i < 1000; ++i) plasticFlow(slow, F, 2e-5, often);
  CHECK((once - often).norm() < 1e-9);
  row("plastic yield 0 or ∞, creep 0 or 1, max 0 or ∞",
      "no flow: bitwise elastic; all of it: energy " + text(body->elasticEnergy().strain / before) +
          " of what was put in; det F_p - 1 at most " + text(volume) + "; 1 and 1000 steps differ by " +
          text((once - often).norm()));
}

TEST_CASE(
    "a hundred times the modulus while running: the step follows at once, energy grows by no more than the change") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(cube(rubber(1e4), 0.01));
  Body &body = *simulator.body(id);
  displace(body, Vec3(1.1, 1.0, 0.95).asDiagonal());
  for (int i = 0; i < 100; ++i) REQUIRE(simulator.step());
  const double step = simulator.stepper().stepSize();
  const Diagnostics::Energy before = simulator.diagnostics().energy(id);
  simulator.world().setConstitution(id, {{rubber(1e6)}, kLatticeStabilisation});
  CHECK_THAT(simulator.stepper().stepSize(), WithinRel(0.1 * step, 1e-9));
  const double allowed = before.kinetic + 100.0 * (before.elastic + before.stabilisation);
  double most = 0.0;
  for (int i = 0; i < 1000; ++i) {
    REQUIRE(simulator.step());
    most = std::max(most, shapes::totalEnergy(simulator, id));
  }
  CHECK(most < 1.02 * allowed);  // velocity Verlet: (omega dt)²/4 of the fastest modes
  CHECK_FALSE(told(simulator, "stopped"));
  CHECK_FALSE(told(simulator, "smaller_step"));
  row("E × 100 while running",
      "next step 0.1 of the last; energy at most " + text(most / allowed) + " of kinetic + 100 elastic");
}
