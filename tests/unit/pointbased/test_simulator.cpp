// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>

#include "c3de/core/thread_pool.h"
#include "contact_cases.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

std::unique_ptr<Body> organ(double spacing = 0.02, Material material = {}) {
  return shapes::makeBody(shapes::restState(shapes::horseshoe(), spacing), {material}, "organ");
}

WorldSettings falling() {
  return WorldSettings{.gravity = Vec3(0, -9.81, 0),
                       .box = {.enabled = true, .min = Vec3(-0.2, -0.1, -0.3), .max = Vec3(0.5, 0.6, 0.4)},
                       .damping = 6.0};
}

}  // namespace

TEST_CASE("a body at rest stays at rest for 10 000 steps") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(organ(0.03));
  const std::uint64_t before = simulator.stateHash();
  for (int i = 0; i < 10000; ++i) REQUIRE(simulator.step());
  CHECK(simulator.stateHash() == before);
  CHECK(simulator.diagnostics().energy(id).kinetic == 0.0);
}

TEST_CASE("a free spinning and vibrating body keeps its energy and momenta") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(organ(0.025));
  Body &body = *simulator.body(id);
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 &X = body.rest().positions[i];
    body.state().velocities[i] = Vec3(1, 2, 0.5).cross(X) + Vec3(0.1 * std::sin(30.0 * X[0]), 0.2, 0.0);
  }
  const shapes::Momenta before = shapes::momenta(body);
  const double e0 = simulator.diagnostics().energy(id).kinetic;
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    REQUIRE(simulator.step());
    const auto e = simulator.diagnostics().energy(id);
    worst = std::max(worst, std::abs(e.kinetic + e.elastic + e.stabilisation - e0) / e0);
  }
  const shapes::Momenta after = shapes::momenta(body);
  CHECK((after.linear - before.linear).norm() < 1e-12 * before.linear.norm());
  CHECK((after.angular - before.angular).norm() < 1e-11 * before.angular.norm());
  // Velocity Verlet oscillates about the true energy by (omega dt)²/8 of the excited modes.
  CHECK(worst < 0.02);
}

TEST_CASE("a soft body falls into the box, comes to rest and stays finite") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ());
  while (simulator.time() < 3.0) REQUIRE(simulator.step());
  const Body &body = *simulator.body(id);
  double fastest = 0.0, lowest = 1.0;
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    fastest = std::max(fastest, body.state().velocities[i].norm());
    lowest = std::min(lowest, body.rest().origin[1] + body.rest().positions[i][1] + body.state().displacements[i][1]);
  }
  CHECK(fastest < 0.02);
  CHECK(lowest > -0.1 - 0.5 * body.rest().spacing);
  CHECK_THAT(body.totalMass(), WithinRel(1060.0 * 0.005, 1e-12));
}

TEST_CASE("state hash: the same for 1 and 2 threads and from run to run, reset gives the initial one") {
  std::vector<std::uint64_t> hashes;
  for (const unsigned threads : {1u, 2u, 2u}) {
    c3de::ThreadPool pool(threads);
    Simulator simulator(shapes::loopsOf(pool));
    simulator.setWorld(falling());
    simulator.addBody(organ());
    const std::uint64_t initial = simulator.stateHash();
    for (int i = 0; i < 300; ++i) REQUIRE(simulator.step());
    hashes.push_back(simulator.stateHash());
    CHECK(hashes.back() != initial);
    simulator.reset();
    CHECK(simulator.stateHash() == initial);
    CHECK(simulator.time() == 0.0);
    for (int i = 0; i < 300; ++i) REQUIRE(simulator.step());
    CHECK(simulator.stateHash() == hashes.back());
  }
  CHECK(hashes[0] == hashes[1]);
  CHECK(hashes[1] == hashes[2]);
}

TEST_CASE("a step that is too large is divided, and says so") {
  Simulator simulator;
  WorldSettings world = falling();
  world.dt = 1.0 / 60.0;
  simulator.setWorld(world);
  simulator.addBody(organ());
  for (int i = 0; i < 30; ++i) REQUIRE(simulator.step());
  CHECK_THAT(simulator.time(), WithinRel(0.5, 1e-9));
  REQUIRE_FALSE(simulator.diagnostics().events().empty());
  CHECK(simulator.diagnostics().events().front().kind == "substep");
}

TEST_CASE("a step that leaves the finite numbers is refused, the state before it is kept, and reset leads out") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ(0.03));
  // An obstacle that returns invalid values from some moment on: the failure occurs inside the step.
  bool broken = false;
  Obstacle obstacle;
  obstacle.name = "broken";
  obstacle.closest = [&broken](std::span<const Vec3> points, std::span<const double>, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = {broken ? Vec3(std::nan(""), 0, 0) : Vec3(0, 1, 0), broken ? 0.0 : 1e-9};
  };
  for (int i = 0; i < 5; ++i) REQUIRE(simulator.step());
  const std::uint64_t before = simulator.stateHash();
  const double time = simulator.time();
  // A new obstacle is queried for every point; a known one would only be queried for points that have moved.
  simulator.addObstacle(obstacle);
  broken = true;
  const auto failed = simulator.step();
  REQUIRE_FALSE(failed);
  CHECK_THAT(failed.error().text, Contains("organ") && Contains("phyxel"));
  CHECK(simulator.failed());
  CHECK(simulator.stateHash() == before);
  CHECK(simulator.time() == time);
  CHECK(std::isfinite(simulator.diagnostics().energy(id).elastic));
  CHECK_FALSE(simulator.step());
  broken = false;
  simulator.reset();
  CHECK_FALSE(simulator.failed());
  CHECK(simulator.step());
}

TEST_CASE("a grabbed region follows the hand and the force vanishes on release") {
  Simulator simulator;
  simulator.setWorld({.damping = 1.0});
  const std::size_t id = simulator.addBody(organ());
  const Body &body = *simulator.body(id);
  Grab grab{.phyxels = {0, 1, 2, 3, 4, 5, 6, 7}, .weights = std::vector<double>(8, 1.0 / 8.0), .maxForce = 10.0};
  Vec3 start = Vec3::Zero();
  for (Index i = 0; i < 8; ++i) start += (body.rest().origin + body.rest().positions[i]) / 8.0;
  grab.target = start + Vec3(0.05, 0.0, 0.0);
  simulator.stepper().setGrab(id, grab);
  while (simulator.time() < 0.02) REQUIRE(simulator.step());
  CHECK(simulator.stepper().grabStatus(id)->force[0] > 0.0);
  while (simulator.time() < 4.0) REQUIRE(simulator.step());
  CHECK((simulator.stepper().grabStatus(id)->point - grab.target).norm() < 0.005);
  simulator.stepper().moveGrab(id, Vec3(1e6, 0, 0));  // a tool that is pulled far away pulls no harder
  REQUIRE(simulator.step());
  CHECK_THAT(simulator.stepper().grabStatus(id)->force.norm(), WithinRel(10.0, 1e-9));
  for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
  simulator.stepper().releaseGrab(id);
  CHECK_FALSE(simulator.stepper().grabStatus(id));
  for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
}

TEST_CASE("a material that is changed while running changes the step at once") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ());
  while (simulator.time() < 0.5) REQUIRE(simulator.step());
  const double before = simulator.stepper().stepSize();
  Material stiff = simulator.body(id)->material();
  stiff.youngsModulus *= 100.0;
  simulator.world().setConstitution(id, {{stiff}, kCloudStabilisation});
  CHECK_THAT(simulator.stepper().stepSize(), WithinRel(0.1 * before, 1e-6));
  while (simulator.time() < 1.0) REQUIRE(simulator.step());
}

TEST_CASE("a probe reports where its material point is") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -10, 0), .dt = 1e-3});
  const std::size_t id = simulator.addBody(organ(0.03));
  simulator.world().addProbe("tip", id, Vec3(0.3, 0.2, 0.1));
  CHECK((simulator.world().probeState(simulator.world().probes()[0]).position - Vec3(0.3, 0.2, 0.1)).norm() < 1e-12);
  for (int i = 0; i < 100; ++i) REQUIRE(simulator.step());
  CHECK_THAT(simulator.world().probeState(simulator.world().probes()[0]).position[1], WithinAbs(0.2 - 0.05, 1e-9));
  CHECK_THAT(simulator.world().probeState(simulator.world().probes()[0]).velocity[1], WithinAbs(-1.0, 1e-9));
}

TEST_CASE("a block on a slippery floor sinks under its own weight as the bar formula says") {
  // Uniaxial stress rho g (H - y). The floor holds the lowest phyxels half a spacing above it, so what is compressed is
  // the column above them: the top sinks by rho g (H - d/2)^2 / (2 E) = 2.155 mm (2.4525 mm for d = 0).
  const double height = 0.1, youngs = 20000.0, density = 1000.0;
  for (const double poisson : {0.0, 0.3}) {
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, -9.81, 0),
                        .box = {.enabled = true, .min = Vec3(-1, 0, -1), .friction = 0.0},
                        .damping = 20.0});
    const auto shape = shapes::box(Vec3(0, 0, 0), Vec3(height, height, height));
    const Material material{.law = MaterialLaw::stVenantKirchhoff,
                            .youngsModulus = youngs,
                            .poissonRatio = poisson,
                            .restDensity = density};
    const std::size_t id = simulator.addBody(shapes::makeBody(shapes::restState(shape, 0.0125), {material}, "block"));
    simulator.world().addProbe("top", id, Vec3(0.05, height, 0.05));
    while (simulator.time() < 2.0) REQUIRE(simulator.step());
    const double sunk = height - simulator.world().probeState(simulator.world().probes()[0]).position[1];
    const double column = height - 0.5 * simulator.body(id)->rest().spacing;
    const double formula = density * 9.81 * column * column / (2.0 * youngs);
    INFO("nu = " << poisson << ": sunk by " << 1e3 * sunk << " mm, formula " << 1e3 * formula << " mm");
    // Measured: -4 % and +2 %, the error of one evaluation per phyxel at 8 layers, plus the law's at 5 % strain. Four
    // times too stiff, as published, would be 75 % off.
    CHECK_THAT(sunk, WithinRel(formula, 0.06));
  }
}

TEST_CASE("another integrator goes on from the same positions, velocities and plastic state") {
  const Material clay{.plastic = {0.02, 1.0, 1.0 / 60.0, Plasticity::kNever}};
  Simulator simulator;
  WorldSettings world = falling();
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(organ(0.03, clay));
  while (simulator.time() < 0.4) REQUIRE(simulator.step());
  REQUIRE_FALSE(simulator.body(id)->state().history.plasticInverse.empty());
  double flowed = 0.0;
  for (const Mat3 &F : simulator.body(id)->state().history.plasticInverse) flowed += (F - Mat3::Identity()).norm();
  CHECK(flowed > 0.0);
  for (const Integrator next : {Integrator::implicitSdirk, Integrator::implicitMidpoint, Integrator::backwardEuler,
                                Integrator::quasiStatic, Integrator::explicitVerlet}) {
    const std::uint64_t before = simulator.stateHash();
    const double time = simulator.time();
    world.integrator = next;
    simulator.setWorld(world);
    CHECK(simulator.stateHash() == before);
    if (next == Integrator::quasiStatic) {
      // A separate solution, however long the motion before it has been.
      CHECK(simulator.loadFactor() == 0.0);
      CHECK_FALSE(simulator.finished());
      continue;
    }
    CHECK(simulator.time() >= time);
    for (int i = 0; i < 3; ++i) REQUIRE(simulator.step());
    CHECK(simulator.stateHash() != before);
    CHECK(std::isfinite(simulator.diagnostics().energy(id).elastic));
  }
}

TEST_CASE("the cheaper integrator is chosen by the stiffness of the body, and another may be asked for") {
  const auto integratorFor = [](double youngsModulus, Integrator asked) {
    Simulator simulator;
    simulator.setWorld({.integrator = asked});
    const Material material{.youngsModulus = youngsModulus};
    const std::size_t id = simulator.addBody(
        shapes::makeBody(shapes::restState(shapes::ball(Vec3::Zero(), 0.05), 0.01), {material}, "ball"));
    const auto [explicitCost, implicitCost] = simulator.stepper().predictedCost(id);
    CHECK(explicitCost > 0.0);
    CHECK(implicitCost > 0.0);
    if (asked == Integrator::automatic)
      CHECK((simulator.stepper().integratorOf(id) == Integrator::implicitSdirk) == (implicitCost < explicitCost));
    // The step that belongs to it.
    CHECK((simulator.stepper().stepSize() == kImplicitStep) ==
          (simulator.stepper().integratorOf(id) == Integrator::implicitSdirk));
    return simulator.stepper().integratorOf(id);
  };
  CHECK(integratorFor(6e3, Integrator::automatic) == Integrator::explicitVerlet);
  CHECK(integratorFor(1e9, Integrator::automatic) == Integrator::implicitSdirk);
  CHECK(integratorFor(6e3, Integrator::implicitSdirk) == Integrator::implicitSdirk);
  CHECK(integratorFor(1e8, Integrator::explicitVerlet) == Integrator::explicitVerlet);
}

TEST_CASE("an automatic step is not divided by a strain of two per cent, and is by a large one") {
  const auto dividedAt = [](double stretch) {
    Simulator simulator;
    const Material material{.youngsModulus = 1e4};
    const std::size_t id = simulator.addBody(
        shapes::makeBody(shapes::restState(shapes::ball(Vec3::Zero(), 0.05), 0.01), {material}, "ball"));
    Body &body = *simulator.body(id);
    for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
      body.state().displacements[i] = stretch * body.rest().positions[i];
    // The bound of the step is that of the forces, which are first computed in the first step.
    REQUIRE(simulator.step());
    CHECK(body.stableStep() < body.stableStepAtRest());
    REQUIRE(simulator.step());
    return shapes::countEvents(simulator, "substep") > 0;
  };
  CHECK_FALSE(dividedAt(-0.02));
  CHECK(dividedAt(-0.4));
}

namespace {

// Oscillating cubes next to one another; with the usual step on a floor.
std::unique_ptr<Simulator> cubes(const std::vector<double> &moduli, Integrator integrator,
                                 const ParallelFor &parallelFor = serialFor(), double dt = 0.0) {
  auto simulator = std::make_unique<Simulator>(parallelFor);
  simulator->setWorld({.gravity = Vec3(0.0, -9.81, 0.0),
                       .box = {dt == 0.0, Vec3(-1.0, -0.01, -1.0), Vec3(9.0, 1.0, 1.0), 0.3},
                       .integrator = integrator,
                       .dt = dt,
                       .sleep = false});
  for (std::size_t k = 0; k < moduli.size(); ++k) {
    const double x = 0.2 * static_cast<double>(k);
    auto body = shapes::latticeBox(Vec3(x, 0.0, 0.0), Vec3(x + 0.1, 0.1, 0.1), 0.025, shapes::rubber(moduli[k]));
    body->setInitialVelocity(Vec3(0.1, 0.2, 0.0), Vec3(0.0, 0.0, 3.0 + x));
    simulator->addBody(std::move(body));
  }
  return simulator;
}

}  // namespace

TEST_CASE("a stiff body does not set the step of a soft one: each moves as it would alone") {
  const double dt = cubes({1e4}, Integrator::explicitVerlet)->stepper().stepSize();
  CHECK(cubes({1e4, 4e6}, Integrator::explicitVerlet)->stepper().stepSize() == dt);
  const auto together = cubes({1e4, 4e6}, Integrator::explicitVerlet, serialFor(), dt);
  const auto soft = cubes({1e4}, Integrator::explicitVerlet, serialFor(), dt);
  const auto stiff = cubes({1e4, 4e6}, Integrator::explicitVerlet, serialFor(), dt);
  REQUIRE(stiff->removeBody(stiff->bodyIds()[0]));
  const auto ids = together->bodyIds();
  CHECK(dt > 15.0 * together->body(ids[1])->stableStepAtRest());
  for (int k = 0; k < 40; ++k) {
    REQUIRE(together->step());
    REQUIRE(soft->step());
    REQUIRE(stiff->step());
  }
  const auto same = [](const Body &a, const Body &b) {
    return a.state().displacements == b.state().displacements && a.state().velocities == b.state().velocities;
  };
  CHECK(same(*together->body(ids[0]), *soft->body(soft->bodyIds()[0])));
  CHECK(same(*together->body(ids[1]), *stiff->body(stiff->bodyIds()[0])));

  // Substeps are reported where the caller has chosen the step, not where the soft body determines it.
  const auto tellsOfSubsteps = [](Simulator &simulator) {
    REQUIRE(simulator.step());
    return shapes::countEvents(simulator, "substep") > 0;
  };
  CHECK(tellsOfSubsteps(*cubes({1e4, 4e6}, Integrator::explicitVerlet, serialFor(), dt)));
  CHECK_FALSE(tellsOfSubsteps(*cubes({1e4, 4e6}, Integrator::explicitVerlet)));
}

TEST_CASE("bodies that go side by side go the same way, bit for bit, and a request ends them all") {
  c3de::ThreadPool pool(3);
  const ParallelFor threads = shapes::loopsOf(pool);
  for (const Integrator integrator : {Integrator::automatic, Integrator::backwardEuler, Integrator::quasiStatic}) {
    const std::vector<double> moduli{1e4, 1e5, 2e4, 3e9, 5e4};
    const auto one = cubes(moduli, integrator), three = cubes(moduli, integrator, threads);
    for (int k = 0; k < 3; ++k) {
      REQUIRE(one->step());
      REQUIRE(three->step());
    }
    CHECK(one->stateHash() == three->stateHash());
    REQUIRE(one->diagnostics().events().size() == three->diagnostics().events().size());
    for (std::size_t k = 0; k < one->diagnostics().events().size(); ++k)
      CHECK(one->diagnostics().events()[k].text == three->diagnostics().events()[k].text);
    for (const std::size_t id : three->bodyIds()) CHECK(three->diagnostics().costOf(id) >= 0.0);

    class Later final : public StopRequest {
     public:
      [[nodiscard]] bool isRaised() const noexcept override { return left_.fetch_sub(1) <= 0; }

     private:
      mutable std::atomic<int> left_{40};
    };
    const std::uint64_t before = three->stateHash();
    const Later stop;
    const auto ended = three->step(&stop);
    REQUIRE(!ended);
    CHECK(ended.error().ended);
    CHECK(ended.error().body != 0);
    CHECK(three->stateHash() == before);
    CHECK(three->diagnostics().activity().empty());
    REQUIRE(three->step());
  }
}
