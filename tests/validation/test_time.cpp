// SPDX-License-Identifier: Apache-2.0
// The point-based engine in time: orders of convergence, momenta, reversal, impact, relaxation, flow.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "solid_shapes.h"
#include "solved_body.h"
#include "support/catch.h"
#include "validation_table.h"

using namespace pointbased;
using namespace validation;

namespace {

constexpr double kE = 1e4, kPi = std::numbers::pi;

Problem moving(const BodyShape &shape, double spacing, Integrator integrator,
               MaterialLaw law = MaterialLaw::stVenantKirchhoff) {
  Problem problem = Problem::rubber(shape, spacing, law);
  problem.world.integrator = integrator;
  return problem;
}

/// A small free block that spins and oscillates in a smooth mode.
void setGoing(SolvedBody &solved) {
  Body &body = solved.body();
  for (std::size_t i = 0; i < solved.rest().phyxelCount(); ++i) {
    const Vec3 &X = solved.rest().positions[i];
    body.state().velocities[i] =
        Vec3(1, 2, 0.5).cross(X) + Vec3(0.05, 0.1, 0) + 0.05 * Vec3(std::sin(40 * X[0]), 0, std::cos(30 * X[0]));
  }
}

BodyShape block() { return solids::box(Vec3::Zero(), Vec3(0.08, 0.04, 0.04)); }

double meanDistance(const std::vector<Vec3> &a, const std::vector<Vec3> &b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

TEST_CASE("order of convergence in dt: Verlet, midpoint, SDIRK 2, backward Euler 1", "[truth]") {
  struct Scheme {
    const char *name;
    Integrator integrator;
    double dt, order;
  };
  // The slowest modes of the block have periods of some 0.1 s; dt resolves the excited ones.
  for (const Scheme &scheme :
       {Scheme{"velocity Verlet", Integrator::explicitVerlet, 1e-3, 2},
        Scheme{"midpoint", Integrator::implicitMidpoint, 1e-3, 2}, Scheme{"SDIRK2", Integrator::implicitSdirk, 1e-3, 2},
        Scheme{"backward Euler", Integrator::backwardEuler, 1e-4, 1}}) {
    const Stopwatch watch;
    const auto after = [&](Integrator integrator, double dt) {
      Problem problem = moving(block(), 0.02, integrator);
      problem.world.dt = dt;
      problem.world.tolerance = 1e-13;
      SolvedBody body(problem);
      // A single smooth motion: rough modes would need smaller steps to show the order.
      for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
        body.body().state().velocities[i] =
            Vec3(0.02 * std::cos(kPi * (body.rest().positions[i][0] + 0.04) / 0.08), 0, 0);
      const int steps = static_cast<int>(std::lround(0.02 / dt));
      for (int i = 0; i < steps; ++i)
        if (const auto done = body.simulator().step(); !done) throw std::runtime_error(done.error().text);
      return body.body().state().displacements;
    };
    const auto exact = after(Integrator::explicitVerlet, 2e-5);
    const double coarse = meanDistance(after(scheme.integrator, scheme.dt), exact);
    const double fine = meanDistance(after(scheme.integrator, 0.5 * scheme.dt), exact);
    judge(
        std::string("free block, ") + scheme.name, "order in dt",
        {.truth = scheme.order, .ours = std::log2(coarse / fine), .limit = 0.1, .milliseconds = watch.milliseconds()});
  }
}

TEST_CASE("order of convergence in the spacing: 2 where the solution is smooth", "[truth]") {
  const Stopwatch watch;
  // Pure shear of the section by torsion between 30 % and 70 % of a bar: no singular edge is involved.
  const double a = 0.04, L = 0.2;
  const auto error = [&](int n) {
    Problem problem = Problem::rubber(solids::box(Vec3(0, -a / 2, -a / 2), Vec3(L, a / 2, a / 2)), a / n);
    problem.hold(face(0, 0.0)).turn(face(0, L), Vec3(2, 0, 0), Vec3(L, 0, 0));
    problem.world.loadSteps = 1;
    SolvedBody body(problem);
    const auto turn = [&](double x) {
      return (body.displacementAt(Vec3(x, a / 2, 0))[2] - body.displacementAt(Vec3(x, -a / 2, 0))[2]) / a;
    };
    const double rate = (turn(0.7 * L) - turn(0.3 * L)) / (0.4 * L);
    return std::abs(body.torqueAboutOrigin(1)[0] / (kE / 2.6 * std::pow(a, 4) * rate) / 0.140577 - 1.0);
  };
  const double coarse = error(4), fine = error(8);
  judge("square bar, small twist, 4 and 8 layers", "order in the spacing",
        {.truth = 2.0, .ours = std::log2(coarse / fine), .limit = 0.25, .milliseconds = watch.milliseconds()});
}

TEST_CASE("1e5 explicit steps of a free spinning body: momenta and energy", "[truth]") {
  SolvedBody body(moving(block(), 0.02, Integrator::explicitVerlet, MaterialLaw::neoHookean));
  setGoing(body);
  const Vec3 p = body.momentum(), l = body.angularMomentum();
  const auto energy = [&] {
    const auto e = body.simulator().diagnostics().energy(body.id());
    return e.kinetic + e.elastic + e.stabilisation;
  };
  const double e0 = energy();
  double early = 0.0, late = 0.0;
  const Stopwatch watch;
  for (int i = 0; i < 100000; ++i) {
    REQUIRE(body.simulator().step());
    if (i < 10000)
      early += energy() / 10000.0;
    else if (i >= 90000)
      late += energy() / 10000.0;
  }
  const double ms = watch.milliseconds();
  // Round-off of 1e5 sums.
  judge("free block, 1e5 Verlet steps", "change of momentum",
        {.ours = (body.momentum() - p).norm(), .limit = 1e-10, .milliseconds = ms, .scale = p.norm()});
  judge("free block, 1e5 Verlet steps", "change of ang. momentum",
        {.ours = (body.angularMomentum() - l).norm(), .limit = 1e-10, .milliseconds = ms, .scale = l.norm()});
  // Symplectic: bounded; the fastest modes contribute little.
  judge("free block, 1e5 Verlet steps", "drift of mean energy",
        {.ours = late - early, .limit = 1e-3, .milliseconds = ms, .scale = e0});
  judge("free block, 1e5 Verlet steps", "energy at the end",
        {.ours = energy() - e0, .limit = 0.02, .milliseconds = ms, .scale = e0});
}

TEST_CASE("1e6 explicit steps of a free vibration: the energy does not drift", "[truth]") {
  // A bar that stretches, bends both ways and spins, nothing damped, at the automatic step.
  const double length = 0.12;
  SolvedBody body(moving(solids::box(Vec3::Zero(), Vec3(length, 0.02, 0.02)), 0.02, Integrator::explicitVerlet,
                         MaterialLaw::neoHookean));
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 &X = body.rest().positions[i];
    const double bend = std::cos(2.0 * kPi * X[0] / length);
    body.body().state().velocities[i] =
        0.05 * Vec3(std::sin(kPi * X[0] / length), bend, 0.5 * bend) + Vec3(1, 2, 0.5).cross(X);
  }
  const auto energy = [&] {
    const auto e = body.simulator().diagnostics().energy(body.id());
    return e.kinetic + e.elastic + e.stabilisation;
  };
  // The energy of Verlet oscillates about a conserved one. Two measures of its drift: means of the first and last
  // thousandth, some 80 periods of the slowest mode each, and the straight line of least squares through all of it.
  constexpr int kSteps = 1000000, kPart = kSteps / 1000, kEvery = 10;
  const double e0 = energy();
  double first = 0.0, last = 0.0, low = e0, high = e0, n = 0.0, x1 = 0.0, x2 = 0.0, y1 = 0.0, xy = 0.0;
  const Stopwatch watch;
  for (int i = 0; i < kSteps; ++i) {
    if (!body.simulator().step()) FAIL(body.body().stopMessage());
    const bool early = i < kPart, late = i >= kSteps - kPart;
    if (!early && !late && i % kEvery != 0) continue;
    const double e = energy();
    low = std::min(low, e);
    high = std::max(high, e);
    if (early) first += e / kPart;
    if (late) last += e / kPart;
    if (i % kEvery != 0) continue;
    const double x = static_cast<double>(i) / kSteps;
    n += 1.0;
    x1 += x;
    x2 += x * x;
    y1 += e;
    xy += x * e;
  }
  const double ms = watch.milliseconds();
  const std::string name = "free bar of " + std::to_string(body.rest().phyxelCount()) + " phyxels, 1e6 Verlet steps";
  judge(name, "drift, first to last 1/1000", {.ours = last - first, .limit = 1e-4, .milliseconds = ms, .scale = e0});
  judge(name, "drift, line of least squares",
        {.ours = (n * xy - x1 * y1) / (n * x2 - x1 * x1), .limit = 1e-4, .milliseconds = ms, .scale = e0});
  // Its oscillation: (omega dt)²/4 of each mode's share.
  judge(name, "swing of the energy", {.ours = high - low, .limit = 0.01, .milliseconds = ms, .scale = e0});
}

TEST_CASE("time reversal of explicit steps", "[truth]") {
  // A fixed step: the automatic one follows the stiffness of the current state, and so differs on the way back.
  Problem problem = moving(block(), 0.02, Integrator::explicitVerlet, MaterialLaw::neoHookean);
  problem.world.dt = 5e-4;
  SolvedBody body(problem);
  REQUIRE(body.body().stableStepAtRest() > 4 * problem.world.dt);
  setGoing(body);
  const std::vector<Vec3> start = body.body().state().displacements;
  const Stopwatch watch;
  for (int i = 0; i < 1000; ++i) REQUIRE(body.simulator().step());
  const double way = meanDistance(body.body().state().displacements, start);
  for (Vec3 &v : body.body().state().velocities) v = -v;
  for (int i = 0; i < 1000; ++i) REQUIRE(body.simulator().step());
  judge("free block, 1000 steps there and back", "distance from start",
        {.ours = meanDistance(body.body().state().displacements, start),
         .limit = 1e-9,
         .milliseconds = watch.milliseconds(),
         .scale = way});
}

TEST_CASE("free fall and a bar against a wall", "[truth]") {
  {
    Problem problem = moving(block(), 0.02, Integrator::explicitVerlet);
    problem.world.gravity = Vec3(0, 0, -9.81);
    SolvedBody body(problem);
    body.run(0.5);
    const double t = body.simulator().time();
    judge("free fall, 0.5 s", "way, m",
          {.truth = -0.5 * 9.81 * t * t,
           .ours = body.displacementAt(Vec3(0.04, 0.02, 0.02))[2],
           .limit = 1e-10,
           .milliseconds = body.milliseconds()});
  }
  // A bar of nu = 0 hits a wall with its whole end: a plane wave travels to the free end and back.
  const double L = 0.2, a = 0.02, speed = std::sqrt(kE / 1000.0), v = 0.01 * speed;
  for (const int n : {20, 80}) {
    Problem problem =
        moving(solids::box(Vec3(0, 0, 0), Vec3(L, a, a)), L / n, Integrator::explicitVerlet, MaterialLaw::linear);
    problem.material.poissonRatio = 0.0;
    problem.world.box = {.enabled = true, .min = Vec3(-1e-4, -1, -1), .max = Vec3(1, 1, 1), .friction = 0.0};
    SolvedBody body(problem);
    body.body().setInitialVelocity(Vec3(-v, 0, 0), Vec3::Zero());
    body.simulator().reset();
    const double start = body.momentum()[0];
    double down = 0.0, up = 0.0;
    while (body.simulator().time() < 1e-4 / v + 3.5 * L / speed) {
      REQUIRE(body.simulator().step());
      const double p = body.momentum()[0] / start;  // 1 … -1, linear while the wave travels
      if (down == 0.0 && p < 0.8) down = body.simulator().time();
      if (up == 0.0 && p < -0.8) up = body.simulator().time();
    }
    const std::string name = "bar against a wall, " + std::to_string(n) + " cells long";
    judge(name, "time of contact, s",
          {.truth = 2 * L / speed,
           .ours = up > 0.0 ? (up - down) / 0.8 : 0.0,
           .limit = n == 20 ? 0.05 : 0.02,
           .milliseconds = body.milliseconds()});
    judge(name, "speed afterwards / before",
          {.truth = 1.0,
           .ours = -body.momentum()[0] / start,
           .limit = n == 20 ? 0.05 : 0.02,
           .milliseconds = body.milliseconds()});
  }
}

TEST_CASE("Hertz: a ball bounces off a wall", "[truth]") {
  // Slow relative to the waves in it: contact lasts long against its vibrations, which receive almost none of its
  // energy.
  const double radius = 0.05, speed = 0.01 * std::sqrt(kE / 1000.0), nu = 0.3;
  for (const int cells : {8, 14}) {  // across the radius
    Problem problem = moving(solids::ball(Vec3(0, 0, 0), radius), radius / cells, Integrator::explicitVerlet,
                             MaterialLaw::neoHookean);
    problem.material.poissonRatio = nu;
    problem.world.box = {.enabled = true, .min = Vec3(-1, -1, -radius - 1e-4), .max = Vec3(1, 1, 1), .friction = 0.0};
    SolvedBody body(problem);
    body.body().setInitialVelocity(Vec3(0, 0, -speed), Vec3::Zero());
    body.simulator().reset();
    const double mass = body.body().totalMass(), start = body.momentum()[2];
    const double truth = 2.868 * std::pow(std::pow(mass * (1 - nu * nu) / kE, 2) / (radius * speed), 0.2);
    const auto energy = [&] {
      const Diagnostics::Energy e = body.simulator().diagnostics().energy(body.id());
      return e.kinetic + e.elastic + e.stabilisation;
    };
    const double before = energy();
    double first = -1.0, last = 0.0;
    while (body.simulator().time() < 1e-4 / speed + 1.5 * truth) {
      REQUIRE(body.simulator().step());
      const auto &active = body.body().contact.active;
      if (std::none_of(active.begin(), active.end(), [](const Contact &c) { return c.normalImpulse > 0.0; })) continue;
      last = body.simulator().time();
      if (first < 0.0) first = last;
    }
    const std::string name = "ball of " + std::to_string(cells) + " cells against a wall, 0.01 c";
    judge(
        name, "time of contact, s",
        {.truth = truth, .ours = last - first, .limit = cells == 8 ? 0.1 : 0.08, .milliseconds = body.milliseconds()});
    judge(name, "speed afterwards / before",
          {.truth = 1.0,
           .ours = -body.momentum()[2] / start,
           .limit = cells == 8 ? 0.03 : 0.02,
           .milliseconds = body.milliseconds()});
    judge(name, "energy afterwards / before",
          {.truth = 1.0,
           .ours = energy() / before,
           .limit = cells == 8 ? 0.02 : 0.01,
           .milliseconds = body.milliseconds()});
  }
}

TEST_CASE("Prony relaxation of a bar that is held twisted", "[truth]") {
  // Torsion causes only shear strain, so the torque falls like the shear modulus. Mass damping removes the ringing.
  const double a = 0.02, L = 0.04, share = 0.6, tau = 1.0, ramp = 0.2;
  Problem problem =
      moving(solids::box(Vec3(0, -a / 2, -a / 2), Vec3(L, a / 2, a / 2)), a / 3, Integrator::explicitVerlet);
  problem.hold(face(0, 0.0)).turn(face(0, L), Vec3(2, 0, 0), Vec3(L, 0, 0));
  Problem elastic = problem;
  elastic.world.integrator = Integrator::quasiStatic;
  SolvedBody atOnce(elastic);
  const double initial = atOnce.torqueAboutOrigin(1)[0];
  problem.material.prony[0] = {share, tau};
  problem.recipe.fixes[1].ramp = ramp;
  problem.world.damping = 20.0;
  // Of a strain that grows along the ramp and is then constant.
  const auto truthAt = [&](double t) {
    return 1 - share + share * tau / ramp * (std::exp(ramp / tau) - 1) * std::exp(-t / tau);
  };
  struct Scheme {
    const char *name;
    Integrator integrator;
    double dt, end;
  };
  for (const Scheme &scheme : {Scheme{"Verlet", Integrator::explicitVerlet, 0.0, 3.0},
                               Scheme{"midpoint", Integrator::implicitMidpoint, 0.02, 3.0},
                               Scheme{"SDIRK2", Integrator::implicitSdirk, 0.02, 3.0},
                               Scheme{"backward Euler", Integrator::backwardEuler, 0.02, 3.0}}) {
    problem.world.integrator = scheme.integrator;
    problem.world.dt = scheme.dt;
    const std::string name = std::string("twisted bar, share 0.6 relaxes in 1 s, ") + scheme.name;
    try {
      SolvedBody body(problem);
      for (const double at : {0.5, 1.0, 3.0}) {
        if (at > scheme.end) break;
        body.run(at - 1e-9);
        judge(name, "torque / elastic, " + std::to_string(at).substr(0, 3) + " s",
              {.truth = truthAt(body.simulator().time()),
               .ours = body.torqueAboutOrigin(1)[0] / initial,
               .limit = 0.01,
               .milliseconds = body.milliseconds()});
      }
      std::size_t divided = 0;
      for (const SimulationEvent &event : body.simulator().diagnostics().events())
        divided += event.kind == "smaller_step" ? 1 : 0;
      if (divided > 0) remark(name, "note: " + std::to_string(divided) + " steps had to be repeated with smaller ones");
    } catch (const std::runtime_error &failure) {
      noSolution(name, failure.what());
    }
  }
}

TEST_CASE("Prony relaxation of a bar that is held bent", "[truth]") {
  // The shear modulus relaxes and the bulk modulus does not. By the correspondence principle the torque falls from that
  // of the elastic bar to that of an elastic bar with the long-term modulus, with the time of 9 K G/(3 K + G).
  const double a = 0.02, L = 0.1, share = 0.6, tau = 1.0, ramp = 0.1;
  for (const double nu : {0.3, 0.45}) {
    Problem problem =
        moving(solids::box(Vec3(0, -a / 2, -a / 2), Vec3(L, a / 2, a / 2)), a / 3, Integrator::quasiStatic);
    problem.material.poissonRatio = nu;
    problem.turn(face(0, 0.0), Vec3(0, -1, 0), Vec3(0, 0, 0)).turn(face(0, L), Vec3(0, 1, 0), Vec3(L, 0, 0));
    Problem end = problem;
    const double K = problem.material.bulkModulus(), G = problem.material.mu(), left = (1 - share) * G;
    end.material.youngsModulus = 9 * K * left / (3 * K + left);
    end.material.poissonRatio = (3 * K - 2 * left) / (2 * (3 * K + left));
    SolvedBody atOnce(problem), inTheEnd(end);
    const double initial = atOnce.reaction(1).torque[1], last = inTheEnd.reaction(1).torque[1];
    const double time = tau * (3 * K + G) / (3 * K + left);
    problem.material.prony[0] = {share, tau};
    for (Fix &fix : problem.recipe.fixes) fix.ramp = ramp;
    problem.world.damping = 20.0;
    problem.world.dt = 0.02;
    problem.world.integrator = Integrator::implicitSdirk;
    const std::string name = "bent bar, nu " + std::to_string(nu).substr(0, 4) + ", share 0.6 relaxes in 1 s";
    SolvedBody body(problem);
    for (const double at : {1.0, 3.0, 8.0}) {
      body.run(at - 1e-9);
      const double passed = time / ramp * (std::exp(ramp / time) - 1) * std::exp(-body.simulator().time() / time);
      judge(name, "torque / elastic, " + std::to_string(at).substr(0, 3) + " s",
            {.truth = (last + (initial - last) * passed) / initial,
             .ours = body.reaction(1).torque[1] / initial,
             .limit = at > 4.0 ? 0.002 : 0.01,
             .milliseconds = body.milliseconds()});
    }
  }
}

TEST_CASE("plastic loop of a stretched bar", "[truth]") {
  // Volume-preserving stretch of every phyxel along a path; immediate flow beyond the yield strain Y. In Hencky strain
  // this is perfect plasticity: the elastic part follows the path and stops at sqrt(2/3) Y.
  Problem problem = moving(block(), 0.02, Integrator::explicitVerlet, MaterialLaw::neoHookean);
  const double yield = 0.05;
  problem.material.plastic.yield = yield;
  problem.material.plastic.creep = 1.0;
  SolvedBody solved(problem);
  Body &body = solved.body();
  const double mu = kE / 2.6, most = std::sqrt(2.0 / 3.0) * yield;
  double elastic = 0.0, strain = 0.0;
  const Stopwatch watch;
  const auto go = [&](double to) {
    const int steps = 200;
    const double from = strain;
    for (int i = 1; i <= steps; ++i) {
      const double next = from + (to - from) * i / steps;
      elastic = std::clamp(elastic + next - strain, -most, most);
      strain = next;
      const Mat3 F = Vec3(std::exp(strain), std::exp(-strain / 2), std::exp(-strain / 2)).asDiagonal();
      for (std::size_t p = 0; p < solved.rest().phyxelCount(); ++p)
        body.state().displacements[p] = (F - Mat3::Identity()) * solved.rest().positions[p];
      body.computeGradients(serialFor());
      (void)body.computeFlow(1e-3, serialFor());
      body.computeStresses(1e-3, serialFor());
    }
    Mat3 P = Mat3::Zero();
    for (const Mat3 &vP : body.stresses()) P += vP / problem.shape.volume;
    // Kirchhoff stress difference of the neo-Hookean law: mu (b_axial - b_lateral) of the elastic part.
    const double ours = P(0, 0) * std::exp(strain) - P(1, 1) * std::exp(-strain / 2);
    judge("bar of yield strain 0.05, on the way 0, 0.2, -0.1, 0.05",
          "stress at " + std::to_string(to).substr(0, 5) + ", Pa",
          {.truth = mu * (std::exp(2 * elastic) - std::exp(-elastic)),
           .ours = ours,
           .limit = 1e-6,
           .milliseconds = watch.milliseconds()});
  };
  for (const double to : {0.02, 0.2, 0.15, -0.1, 0.05}) go(to);
}
