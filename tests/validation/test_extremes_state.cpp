// SPDX-License-Identifier: Apache-2.0
// Extremes of the state: crushed and spinning bodies, invalid numbers, fast grabs, long runs, threads and resets.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>

#include "c3de/core/thread_pool.h"
#include "extreme_cases.h"
#include "support/catch.h"

using namespace extremes;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;

std::size_t denormals(std::span<const Vec3> field) {
  std::size_t count = 0;
  for (const Vec3 &v : field)
    for (int c = 0; c < 3; ++c) count += std::fpclassify(v[c]) == FP_SUBNORMAL ? 1 : 0;
  return count;
}

double elastic(Body &body) {
  body.computeGradients(serialFor());
  const ElasticEnergy e = body.elasticEnergy();
  return e.strain + e.stabilisation;
}

// µs a step, the median of the steps after `from` among `steps`.
double medianStep(Simulator &simulator, int steps) {
  std::vector<double> times;
  for (int i = 0; i < steps; ++i) {
    const auto start = std::chrono::steady_clock::now();
    REQUIRE(simulator.step());
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + steps / 2, times.end());
  return times[static_cast<std::size_t>(steps) / 2];
}

enum class Start { flat, point, mirrored, scrambled };

void put(Body &body, Start start) {
  switch (start) {
    case Start::flat: return displace(body, Vec3(1, 1, 0).asDiagonal());
    case Start::point: return displace(body, Mat3::Zero());
    case Start::mirrored: return displace(body, Vec3(1, 1, -1).asDiagonal());
    case Start::scrambled: {
      shapes::Random random(7);
      for (Vec3 &u : body.state().displacements) u = 0.25 * kEdge * random.vector();
      body.forcesCurrent = false;
    }
  }
}

}  // namespace

namespace {

// neo-Hookean under implicit steps from a point is a special case: all of it is at one position, so that round-off
// determines the side to which it opens. It may end up folded over itself with every det F > 0, a local minimum of the
// energy that no law with one evaluation per cell excludes. Then it rests there with a small part of the energy.
void recovers(bool fromPointImplicitly) {
  std::string result;
  for (const MaterialLaw law : {MaterialLaw::neoHookean, MaterialLaw::corotated})
    for (const Integrator integrator :
         {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler})
      for (const Start start : {Start::flat, Start::point, Start::mirrored, Start::scrambled}) {
        if (fromPointImplicitly !=
            (law == MaterialLaw::neoHookean && integrator == Integrator::implicitSdirk && start == Start::point))
          continue;
        CAPTURE(static_cast<int>(law), static_cast<int>(integrator), static_cast<int>(start));
        Simulator simulator;
        simulator.setWorld({.integrator = integrator, .damping = 10.0});
        Material material = rubber(1e4, 0.3, law);
        material.viscosity = 20.0;
        const std::size_t id = simulator.addBody(cube(material));
        Body &body = *simulator.body(id);
        put(body, start);
        const double before = elastic(body), inverted = invertedPart(body);
        bool good = true;
        while (simulator.time() < 3.0 && good) good = simulator.step().has_value();
        const bool recovered = good && invertedPart(body) == 0.0 && elastic(body) < 1e-6 * before;
        CHECK(finite(body));
        CHECK(std::isfinite(elastic(body)));
        CHECK(good);
        CHECK(invertedPart(body) == 0.0);
        // The skin holds a corner that is tucked in: 0.2 %.
        const bool tucked =
            law == MaterialLaw::neoHookean && integrator == Integrator::explicitVerlet && start == Start::mirrored;
        CHECK(elastic(body) < (fromPointImplicitly ? 0.1 : tucked ? 5e-3 : 1e-6) * before);
        CHECK(simulator.diagnostics().energy(id).kinetic < 1e-6 * before);
        if (!recovered || (law == MaterialLaw::neoHookean && integrator == Integrator::explicitVerlet)) {
          static const char *const names[] = {"flat", "a point", "mirrored", "scrambled"};
          result += (result.empty() ? "" : "; ") + std::string(law == MaterialLaw::neoHookean ? "" : "corotated ") +
                    (integrator == Integrator::explicitVerlet  ? ""
                     : integrator == Integrator::implicitSdirk ? "implicit "
                                                               : "Euler ") +
                    names[static_cast<int>(start)] + ": " + text(100.0 * inverted) + " % inverted, " +
                    (recovered ? "recovers"
                     : good    ? "rests folded with " + text(100.0 * elastic(body) / before) + " % of the energy"
                               : "stopped with a report");
        }
      }
  row(fromPointImplicitly ? "start as a point, neo-Hookean, implicit"
                          : "inverted start, neo-Hookean and corotated, three integrators",
      result);
}

}  // namespace

TEST_CASE("flattened, shrunk to a point, mirrored and scrambled bodies recover to their shape") { recovers(false); }
TEST_CASE("a neo-Hookean body shrunk to a point opens under implicit steps, or rests folded, nothing inverted") {
  recovers(true);
}

TEST_CASE("a mirrored St. Venant-Kirchhoff body stays mirrored, finite, and counts as inverted") {
  Simulator simulator;
  simulator.setWorld({.damping = 10.0});
  const std::size_t id = simulator.addBody(cube(rubber(1e4, 0.3, MaterialLaw::stVenantKirchhoff)));
  Body &body = *simulator.body(id);
  put(body, Start::mirrored);
  while (simulator.time() < 1.0) REQUIRE(simulator.step());
  CHECK(finite(body));
  CHECK(invertedPart(body) == 1.0);
  CHECK(std::isfinite(elastic(body)));
  row("inverted start, St. Venant-Kirchhoff",
      "rests mirrored; " + text(100.0 * invertedPart(body)) + " % inverted points, which the report names");
}

TEST_CASE("a rigid rotation strains nothing, at any angle and after many turns") {
  std::string result;
  for (const MaterialLaw law : {MaterialLaw::neoHookean, MaterialLaw::corotated, MaterialLaw::stVenantKirchhoff}) {
    auto body = cube(rubber(1e4, 0.45, law), 0.01);
    displace(*body, Vec3(1.01, 1, 1).asDiagonal());
    const double scale = elastic(*body);
    shapes::evaluate(*body);
    const double pull = largest(body->forces());
    double worst = 0.0, force = 0.0;
    for (const double angle : {1e-8, 0.5 * kPi, kPi, 3.0, 1e4}) {
      displace(*body, Eigen::AngleAxisd(angle, Vec3(1, -2, 3).normalized()).toRotationMatrix());
      worst = std::max(worst, std::abs(elastic(*body)) / scale);
      shapes::evaluate(*body);
      force = std::max(force, largest(body->forces()) / pull);
    }
    CHECK(worst < 1e-11);  // round-off of C over the square of 1 % of strain
    CHECK(force < 1e-10);
    result += (result.empty() ? "" : ", ") + text(force);
  }
  row("rotations by 180° and 1e4 rad", "forces against those of 1 % strain: " + result);
}

TEST_CASE("at ten thousand radians a second the angular momentum stays") {
  // E = 20 GPa: 300 m/s at the corners, half a per cent of strain.
  Simulator simulator;
  const std::size_t id = simulator.addBody(cube(rubber(2e10)));
  Body &body = *simulator.body(id);
  simulator.setWorld({.dt = kStepSafety * body.stableStepAtRest()});
  body.setInitialVelocity(Vec3::Zero(), Vec3(0, 0, 1e4));
  const Momenta before = momenta(body);
  const double energy = simulator.diagnostics().energy(id).kinetic;
  double most = 0.0;
  while (simulator.time() < 10.0 * 2.0 * kPi / 1e4) {
    REQUIRE(simulator.step());
    most = std::max(most, std::abs(shapes::totalEnergy(simulator, id) / energy - 1.0));
  }
  const double drift = (momenta(body).angular - before.angular).norm() / before.angular.norm();
  CHECK(drift < 1e-11);
  CHECK(most < 0.01);
  // With automatic settings the program chooses implicit steps of many turns each: that may be inaccurate, but not
  // invalid.
  Simulator chosen;
  const std::size_t other = chosen.addBody(cube(rubber(2e11)));
  chosen.body(other)->setInitialVelocity(Vec3::Zero(), Vec3(0, 0, 1e4));
  bool good = true;
  for (int i = 0; i < 20 && good; ++i) good = chosen.step().has_value();
  CHECK(told(chosen, "switched"));
  CHECK(finite(*chosen.body(other)));
  // It tears a soft body apart: finite, or stopped with a report.
  Simulator soft;
  const std::size_t third = soft.addBody(cube(rubber(1e4)));
  soft.body(third)->setInitialVelocity(Vec3::Zero(), Vec3(0, 0, 1e4));
  bool held = true;
  for (int i = 0; i < 500 && held; ++i) held = soft.step().has_value();
  CHECK(finite(*soft.body(third)));
  row("1e4 rad/s", "10 turns: angular momentum " + text(drift) + ", energy within " + text(100.0 * most) +
                       " %; implicit steps of 26 turns: " + (good ? "finite" : "stopped with a report") +
                       "; E = 10 kPa: " + (held ? "finite" : "stopped with a report"));
}

namespace {

// A free body whose velocities have decayed below the smallest normal number, as after half a minute of damping.
void fadeOut(Simulator &simulator, double spacing, double speed) {
  simulator.setWorld({.dt = 1e-3, .damping = 50.0});
  const std::size_t id = simulator.addBody(cube(rubber(1e4), spacing));
  simulator.body(id)->setInitialVelocity(speed * Vec3(1, 2, 3), Vec3::Zero());
  for (int i = 0; i < 800; ++i) REQUIRE(simulator.step());
}

}  // namespace

// A denormal number times 0.95 rounds to itself: without flushing it never becomes zero.
TEST_CASE("numbers too small to be normal do not stay in the state of a damped body") {
  const volatile double tiny = std::numeric_limits<double>::denorm_min();
  std::size_t count = 0, all = 0;
  c3de::ThreadPool pool(2);
  for (const ParallelFor &parallelFor : {serialFor(), shapes::loopsOf(pool)}) {
    Simulator simulator(parallelFor);
    fadeOut(simulator, 0.01, 1e-300);
    const State &state = simulator.body(simulator.bodyIds().front())->state();
    count += denormals(state.velocities) + denormals(state.displacements);
    all += 6 * state.velocities.size();
  }
  CHECK(count == 0);
  // The caller's own arithmetic is unchanged.
  CHECK(2.0 * tiny > tiny);
  std::size_t kept = 0;
  std::mutex mutex;
  pool.parallelFor(64, 1, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    for (std::size_t i = begin; i < end; ++i) kept += 2.0 * tiny > tiny ? 1 : 0;
  });
  CHECK(kept == 64);
  row("denormals in the state of a damped free body",
      std::to_string(count) + " of " + std::to_string(all) + " numbers are; the caller's mode stays");
}

TEST_CASE("a body whose velocities have faded to denormal numbers steps as fast as one that moves") {
  Simulator moves, rests;
  fadeOut(moves, 0.005, 1e6 * 1e-3);
  fadeOut(rests, 0.005, 1e-300);
  double ratio = kInfinity;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const double moving = medianStep(moves, 101);
    ratio = std::min(ratio, medianStep(rests, 101) / moving);
  }
  // The best of three, because other processes use the machine.
  CHECK(ratio < 1.2);
  row("denormals: time of a step at rest", text(ratio) + " of one in motion");
}

namespace {

constexpr Index kVictim = 11;

struct Poison {
  const char *name;
  std::function<void(Simulator &, std::size_t)> give;
  bool names;  // a certain phyxel
};

void setDisplacement(Simulator &s, std::size_t id, double value) {
  s.body(id)->state().displacements[kVictim][1] = value;
  s.body(id)->forcesCurrent = false;
}
void setVelocity(Simulator &s, std::size_t id, double value) { s.body(id)->state().velocities[kVictim][2] = value; }
void setModulus(Simulator &s, std::size_t id, double value) {
  s.world().setConstitution(id, {{rubber(value)}, kLatticeStabilisation});
}
void grabAtNowhere(Simulator &s, std::size_t id) {
  s.stepper().setGrab(id, {.phyxels = {kVictim}, .weights = {1.0}, .target = Vec3::Constant(kNaN)});
}

// A body that becomes invalid next to a valid one. `wholly`: as requested; otherwise the mode in which the others
// continue.
void poisoned(const std::vector<Poison> &poisons, std::initializer_list<Integrator> integrators, bool wholly,
              const std::string &name) {
  std::string result;
  bool begun = false;
  for (const Integrator integrator : integrators)
    for (const Poison &poison : poisons) {
      CAPTURE(poison.name, static_cast<int>(integrator));
      const auto world = [&] {
        auto simulator = std::make_unique<Simulator>();
        simulator->setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = integrator, .dt = 1e-3});
        simulator->world().setContact({false, false, 0.0});  // they overlap
        return simulator;
      };
      const auto alone = world(), both = world();
      const std::size_t first = alone->addBody(cube(rubber(1e4)));
      const std::size_t good = both->addBody(cube(rubber(1e4))), victim = both->addBody(cube(rubber(1e4)));
      for (int i = 0; i < 5; ++i) {
        REQUIRE(alone->step());
        REQUIRE(both->step());
      }
      poison.give(*both, victim);
      const Body &body = *both->body(victim);
      REQUIRE(both->step());
      REQUIRE(alone->step());
      CHECK(body.stopped);
      for (int i = 0; i < 4; ++i) {
        REQUIRE(both->step());
        REQUIRE(alone->step());
      }
      CHECK(both->body(good)->state().displacements == alone->body(first)->state().displacements);
      CHECK(both->body(good)->state().velocities == alone->body(first)->state().velocities);
      CHECK(told(*both, "stopped"));
      const bool kept = finite(body), named = body.stopped && body.stopped->phyxel == 11;
      if (wholly) {
        CHECK(kept);
        if (poison.names) CHECK(named);
      }
      result += (begun ? ", " : "") + std::string(integrator == Integrator::explicitVerlet ? "" : "implicit ") +
                poison.name + (!body.stopped ? " (ignored)" : "") + (kept ? "" : " (stays in the state)") +
                (poison.names && !named && body.stopped ? " (another phyxel is named)" : "");
      begun = true;
      both->reset();
      CHECK(finite(*both->body(victim)));
    }
  row(name, result);
}

const std::vector<Poison> kStates = {
    {"x = NaN", [](Simulator &s, std::size_t id) { setDisplacement(s, id, kNaN); }, true},
    {"x = inf", [](Simulator &s, std::size_t id) { setDisplacement(s, id, kInfinity); }, true},
    {"v = NaN", [](Simulator &s, std::size_t id) { setVelocity(s, id, kNaN); }, true},
    {"v = inf", [](Simulator &s, std::size_t id) { setVelocity(s, id, -kInfinity); }, true},
    {"v = 1e300", [](Simulator &s, std::size_t id) { setVelocity(s, id, 1e300); }, true}};
const std::initializer_list<Integrator> kBoth = {Integrator::explicitVerlet, Integrator::implicitSdirk};

}  // namespace

TEST_CASE("a modulus that is no number stops its body in one step in the last good state, others go on") {
  poisoned({{"E = NaN", [](Simulator &s, std::size_t id) { setModulus(s, id, kNaN); }, false},
            {"E = inf", [](Simulator &s, std::size_t id) { setModulus(s, id, kInfinity); }, false}},
           kBoth, true,
           "E = NaN or infinite while running: stopped in one step in the last good state, others bitwise as alone");
}

TEST_CASE("numbers that are none in x and v are caught in one step and named, others go on") {
  poisoned(kStates, kBoth, false,
           "NaN and infinity put into x and v between steps: caught in one step, others bitwise as alone");
}

TEST_CASE("numbers that are none in x and v leave the body in its last good state, the phyxel named") {
  poisoned(kStates, kBoth, true, "NaN and infinity put into x and v between steps: last good state, phyxel named");
}

// Forces follow from the state, so that the step can be repeated: implicit steps recompute them in any case.
TEST_CASE("a force that is none is caught in one step, which is done again without it") {
  std::string result;
  for (const Integrator integrator : kBoth)
    for (const double value : {kNaN, kInfinity}) {
      CAPTURE(value, static_cast<int>(integrator));
      Simulator simulator;
      simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = integrator, .dt = 1e-3});
      const std::size_t id = simulator.addBody(cube(rubber(1e4)));
      Body &body = *simulator.body(id);
      for (int i = 0; i < 5; ++i) REQUIRE(simulator.step());
      body.forces()[kVictim][0] = value;
      for (int i = 0; i < 5; ++i) REQUIRE(simulator.step());
      CHECK_FALSE(body.stopped);
      CHECK(finite(body));
      CHECK(told(simulator, "smaller_step") == (integrator == Integrator::explicitVerlet));
      // An undisturbed free fall, up to the order of the steps: implicit ones of order 2, explicit ones exact.
      for (const Vec3 &u : body.state().displacements) CHECK((u - Vec3(0, -0.5 * 9.81 * 1e-4, 0)).norm() < 1e-9);
      result += (result.empty() ? "" : ", ") +
                std::string(integrator == Integrator::explicitVerlet ? "" : "implicit ") + "f = " + text(value);
    }
  row("NaN and infinity put into the forces: caught in one step, which is done again", result);
}

TEST_CASE("a hand at no number stops the body it holds in one step, others go on") {
  poisoned({{"hand at NaN", grabAtNowhere, true}}, {Integrator::explicitVerlet}, false, "a hand at NaN, explicit");
}

TEST_CASE("a hand at no number: the phyxel it holds is named, with every integrator") {
  poisoned({{"hand at NaN", grabAtNowhere, true}}, kBoth, true, "a hand at NaN, phyxel named, implicit too");
}

namespace {

void impact(std::initializer_list<double> speeds, double dt, const std::string &name) {
  std::string result;
  bool all = true;
  for (const double speed : speeds) {
    CAPTURE(speed);
    Simulator simulator;
    simulator.setWorld({.dt = dt});
    const std::size_t id = simulator.addBody(cube(rubber(1e4), 0.01, 0.05));  // c_p = 3.7 m/s
    simulator.addObstacle(shapes::sheet(0.0, 0.5, 0.3));
    simulator.body(id)->setInitialVelocity(Vec3(0, -speed, 0), Vec3::Zero());
    const double before = shapes::totalEnergy(simulator, id);
    double most = 0.0, lowest = 1.0;
    bool good = true;
    while (simulator.time() < 0.05 / speed + 0.1 && good) {
      good = simulator.step().has_value();
      most = std::max(most, shapes::totalEnergy(simulator, id) / before);
      lowest = std::min(lowest, shapes::extent(*simulator.body(id), Vec3::UnitY()).low);
    }
    CHECK(good == !simulator.body(id)->stopped);
    CHECK(finite(*simulator.body(id)));
    CHECK(good);
    CHECK(lowest > -0.1 * 0.01);  // a tenth of a spacing
    CHECK(most < 1.01);
    all = all && good;
    result += (result.empty() ? "" : "; ") + text(speed) + " m/s: lowest point " + text(1e3 * lowest) + " mm, energy " +
              text(most) + (good ? "" : ", stopped");
  }
  row(name, (all ? "" : "not met: ") + result + " (more obstacles and integrators: `test_pointbased`)");
}

}  // namespace

// 100 m/s is 27 times the speed of sound: the stable step falls to a thousandth of that at rest.
TEST_CASE("impacts of 1, 10 and 100 m/s go on: no tunnelling, no energy from nowhere") {
  impact({1.0, 10.0, 100.0}, 0.0, "impact at 1, 10, 100 m/s, c_p = 3.7 m/s");
}
TEST_CASE("impacts of 1 and 10 m/s in frames of 1/60 s go on") {
  impact({1.0, 10.0}, 1.0 / 60.0, "impact at 1, 10 m/s, frames of 1/60 s");
}
TEST_CASE("simulation continues after an impact of 100 m/s in frames of 1/60 s", "[slow]") {
  impact({100.0}, 1.0 / 60.0, "impact at 100 m/s, frames of 1/60 s");
}

namespace {

void pulled(Integrator integrator, const std::string &name) {
  std::string result;
  struct ActiveGrab {
    const char *name;
    Vec3 target;
    double most;
    bool must;  // must continue
  };
  for (const ActiveGrab &hand : {ActiveGrab{"teleports 1e9 m away, 5 N", Vec3(1e9, 0, 0), 5.0, true},
                                 ActiveGrab{"1e9 N, 10 cm away", Vec3(0.1, 0, 0), 1e9, true},
                                 ActiveGrab{"1e9 N, 1e9 m away", Vec3(1e9, 1e9, 0), 1e9, false},
                                 ActiveGrab{"without limit, 1e30 m away", Vec3(1e30, 0, 0), kInfinity, false}}) {
    CAPTURE(hand.name, static_cast<int>(integrator));
    Simulator simulator;
    simulator.setWorld({.integrator = integrator, .dt = 2e-3, .damping = 5.0});
    Material material = rubber(2e4);
    material.viscosity = 5.0;
    const std::size_t id = simulator.addBody(cube(material, 0.01));
    Body &body = *simulator.body(id);
    simulator.stepper().setGrab(id, {.phyxels = {0, 1, 2, 3, 4, 5, 6, 7},
                                     .weights = std::vector<double>(8, 1.0 / 8.0),
                                     .target = hand.target,
                                     .maxForce = hand.most});
    bool good = true;
    for (int i = 0; i < 25 && good; ++i) {
      good = simulator.step().has_value();
      const auto status = simulator.stepper().grabStatus(id);
      if (!good) continue;
      CHECK(status);
      if (status) CHECK(status->force.norm() <= hand.most * (1.0 + 1e-9));
    }
    CHECK(finite(body));
    CHECK(good == !body.stopped);
    if (hand.must) CHECK(good);
    const double stretched = elastic(body);
    CHECK((!good || stretched > 1e-6));
    simulator.stepper().releaseGrab(id);
    if (!good) {
      simulator.reset();
      REQUIRE(simulator.step());
    } else {
      for (int i = 0; i < 1500; ++i) REQUIRE(simulator.step());
      CHECK(elastic(body) < 1e-3 * stretched);
      CHECK(invertedPart(body) == 0.0);
    }
    result += (result.empty() ? "" : "; ") + std::string(hand.name) + ": " +
              (!good              ? "stopped with a report, reset leads out"
               : stretched > 1e-6 ? "recovers"
                                  : "feels nothing");
  }
  row(name, result);
}

}  // namespace

TEST_CASE("a hand of 1e9 N and one that teleports: capped, finite or stopped, and recovery after release") {
  pulled(Integrator::explicitVerlet, "a hand of 1e9 N, a teleporting one");
}
// The implicit stages have no term for the spring of the grab.
TEST_CASE("a hand of 1e9 N and one that teleports, implicit") { pulled(Integrator::implicitSdirk, "a hand, implicit"); }

namespace {

void runLong(std::uint64_t steps) {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0)});
  // One bounces without friction and viscosity, one hangs in the air, vibrating and rotating.
  const std::size_t bounces = simulator.addBody(cube(rubber(1e4), 0.02, 0.01));
  const std::size_t second = simulator.addBody(cube(rubber(1e4), 0.02, 0.3));
  simulator.body(second)->setInitialVelocity(Vec3(0, 0, 0), Vec3(5, 3, 2));
  simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.0));
  const auto energy = [&] { return shapes::totalEnergy(simulator, bounces) + shapes::totalEnergy(simulator, second); };
  const double before = energy();
  const std::uint64_t tenth = steps / 10;
  double most = before;
  std::size_t memory = 0;
  std::vector<double> medians;
  for (std::uint64_t part = 0; part < 10; ++part) {
    std::vector<double> times;
    for (std::uint64_t i = 0; i < tenth; ++i) {
      const auto start = std::chrono::steady_clock::now();
      REQUIRE(simulator.step());
      if (times.size() < 10000)
        times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      if (i % 64 == 0) most = std::max(most, energy());
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    medians.push_back(times[times.size() / 2]);
    if (part == 0) memory = residentMemory();
  }
  const std::size_t after = residentMemory();
  // The energy available from gravity: both from their height.
  const double scale = simulator.body(bounces)->totalMass() * 9.81 * 0.31;
  CHECK((most - before) / scale < 0.02);
  CHECK(after <= memory + (1u << 20));  // a leak of ten bytes a step would exceed that
  CHECK(medians.back() < 2.0 * medians.front() + 5.0);
  CHECK(simulator.stepper().stoppedBodies() == 0);
  row(text(static_cast<double>(steps)) + " steps, bouncing",
      "energy grows by " + text(100.0 * (most - before) / scale) + " % of m g h at most; memory +" +
          std::to_string((after - std::min(after, memory)) / 1024) + " KiB; median step " + text(medians.front()) +
          " → " + text(medians.back()) + " µs");
}

}  // namespace

TEST_CASE("100 000 steps: no energy from nowhere, memory and time flat") { runLong(100'000); }
TEST_CASE("10 000 000 steps: no energy from nowhere, memory and time flat", "[.long]") { runLong(10'000'000); }

TEST_CASE("one to four threads, and again: the same bits, with every integrator") {
  std::string result;
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::quasiStatic}) {
    CAPTURE(static_cast<int>(integrator));
    std::vector<std::uint64_t> hashes;
    for (const unsigned threads : {1u, 2u, 4u, 2u}) {
      c3de::ThreadPool pool(threads);
      Simulator simulator(shapes::loopsOf(pool));
      simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = integrator, .dt = 1e-3, .loadSteps = 2});
      // Enough phyxels that loops are divided.
      simulator.addBody(cube(rubber(1e5), 0.005, 5e-6));
      simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
      for (int i = 0; i < (integrator == Integrator::explicitVerlet ? 20 : 3); ++i) REQUIRE(simulator.step());
      hashes.push_back(simulator.stateHash());
    }
    CHECK(std::all_of(hashes.begin(), hashes.end(), [&](std::uint64_t h) { return h == hashes[0]; }));
  }
  row("1, 2, 4 threads, repeated", "explicit, implicit, quasi-static: the same bits");
}

TEST_CASE("pausing changes nothing, and reset is the initial state bit for bit, whatever went before") {
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler}) {
    CAPTURE(static_cast<int>(integrator));
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = integrator, .dt = 1e-3});
    Material material = rubber(1e4);
    material.plastic = {0.02, 0.5, 0.01, 1.0};
    material.prony[0] = {0.3, 0.05};
    const std::size_t id = simulator.addBody(cube(material, 0.02, 0.001));
    simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
    simulator.body(id)->setInitialVelocity(Vec3(0.3, -1, 0), Vec3(0, 0, 2));
    const std::uint64_t initial = simulator.stateHash();
    const auto play = [&](bool pauses) {
      std::vector<Vec3> positions, normals;
      for (int i = 0; i < 120; ++i) {
        REQUIRE(simulator.step());
        if (pauses && i % 10 == 0) {
          // As in a paused program: it only reads.
          simulator.world().surfels(id, positions, normals);
          (void)simulator.diagnostics().energy(id);
          (void)simulator.diagnostics().reactions(id);
          (void)simulator.world().probes();
        }
      }
      return simulator.stateHash();
    };
    const std::uint64_t straight = play(false);
    simulator.reset();
    CHECK(simulator.stateHash() == initial);
    CHECK(simulator.time() == 0.0);
    CHECK(play(true) == straight);
    simulator.stepper().setGrab(id, {.phyxels = {0}, .weights = {1.0}, .target = Vec3(1e12, 0, 0)});
    for (int i = 0; i < 5; ++i) (void)simulator.step();
    simulator.reset();
    CHECK(simulator.stateHash() == initial);
    CHECK_FALSE(simulator.failed());
    CHECK(play(false) == straight);
  }
  row("pause, resume, reset", "bitwise, also after a hand has torn the body to a stop");
}
