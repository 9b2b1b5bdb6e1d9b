// SPDX-License-Identifier: Apache-2.0
// The state of a simulation is saved and restored.
#include <algorithm>
#include <functional>
#include <limits>

#include "contact_cases.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

WorldSettings falling() {
  return WorldSettings{.gravity = Vec3(0, -9.81, 0),
                       .box = {.enabled = true, .min = Vec3(-0.2, -0.02, -0.3), .max = Vec3(0.5, 0.6, 0.4)},
                       .damping = 2.0};
}

std::unique_ptr<Body> organ(const Material &material = {}, double spacing = 0.025) {
  return shapes::makeBody(shapes::restState(shapes::horseshoe(), spacing), {material});
}

void step(Simulator &simulator, int steps) {
  for (int i = 0; i < steps; ++i) REQUIRE(simulator.step());
}

/// Holds the phyxels of the right end and moves them away.
void pull(Simulator &simulator, std::size_t id, int steps) {
  const Body &body = *simulator.body(id);
  Grab grab;
  for (std::size_t i = 0; i < body.rest().phyxelCount() && grab.phyxels.size() < 8; ++i)
    grab.phyxels.push_back(static_cast<Index>(i));
  grab.weights.assign(grab.phyxels.size(), 1.0 / static_cast<double>(grab.phyxels.size()));
  grab.target = body.rest().origin + body.rest().positions[0] + body.state().displacements[0] + Vec3(0.05, 0.05, 0.0);
  simulator.stepper().setGrab(id, grab);
  step(simulator, steps);
}

}  // namespace

TEST_CASE("a state that was kept is taken up again bit for bit, and goes on as it went on", "[checkpoint]") {
  for (const bool viscoelastic : {false, true}) {
    INFO("viscoelastic " << viscoelastic);
    Material material;
    if (viscoelastic) material.prony[0] = {0.3, 0.05};
    Simulator simulator;
    simulator.setWorld(falling());
    const std::size_t id = simulator.addBody(organ(material));
    simulator.world().addProbe("tip", id, simulator.body(id)->rest().origin);
    step(simulator, 150);
    const Checkpoint kept = simulator.archive().checkpoint();
    const std::uint64_t hash = simulator.stateHash();
    const double time = simulator.time();
    step(simulator, 60);
    const std::uint64_t later = simulator.stateHash();

    REQUIRE(simulator.archive().restore(kept));
    CHECK(simulator.stateHash() == hash);
    CHECK(simulator.time() == time);
    CHECK(simulator.steps() == 150);
    CHECK(shapes::countEvents(simulator, "restored") > 0);
    step(simulator, 60);
    CHECK(simulator.stateHash() == later);

    pull(simulator, id, 100);
    REQUIRE(simulator.stateHash() != hash);
    REQUIRE(simulator.archive().restore(kept));
    CHECK(simulator.stateHash() == hash);
    CHECK_FALSE(simulator.stepper().grabStatus(id));
    step(simulator, 60);
    CHECK(simulator.stateHash() == later);
  }
}

TEST_CASE("a state is taken up with the material of now", "[checkpoint]") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ());
  step(simulator, 50);
  const Checkpoint kept = simulator.archive().checkpoint();
  const std::uint64_t hash = simulator.stateHash();
  step(simulator, 50);
  Material other;
  other.youngsModulus *= 4.0;
  other.plastic = {50.0, 0.9, 1.0, Plasticity::kNever};
  simulator.world().setConstitution(id, Constitution{{other}, kCloudStabilisation});
  step(simulator, 50);
  REQUIRE(simulator.archive().restore(kept));
  CHECK(simulator.body(id)->material().youngsModulus == other.youngsModulus);
  CHECK(simulator.body(id)->state().history.plasticInverse.size() == simulator.body(id)->rest().pointCount());
  step(simulator, 20);
  // And back again, where no plastic flow remains.
  simulator.world().setConstitution(id, Constitution{{Material{}}, kCloudStabilisation});
  REQUIRE(simulator.archive().restore(kept));
  CHECK(simulator.stateHash() == hash);
  step(simulator, 20);
}

TEST_CASE("a body that has stopped goes on from a state of before", "[checkpoint]") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ());
  step(simulator, 10);
  const Checkpoint kept = simulator.archive().checkpoint();
  simulator.body(id)->state().velocities[3] = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  simulator.body(id)->keepState();
  (void)simulator.step();
  REQUIRE(simulator.failed());
  REQUIRE(simulator.archive().restore(kept));
  CHECK_FALSE(simulator.failed());
  step(simulator, 20);
}

TEST_CASE("a state of other bodies, or of a simulation that has begun anew, is refused", "[checkpoint]") {
  Simulator simulator;
  simulator.setWorld(falling());
  const std::size_t id = simulator.addBody(organ());
  step(simulator, 5);
  const auto isRefused = [&](const std::function<void()> &change) {
    const Checkpoint kept = simulator.archive().checkpoint();
    change();
    const std::uint64_t hash = simulator.stateHash();
    return !simulator.archive().restore(kept) && simulator.stateHash() == hash;
  };
  CHECK(isRefused([&] { simulator.reset(); }));
  std::size_t other = 0;
  CHECK(isRefused([&] { other = simulator.addBody(organ({}, 0.04)); }));
  CHECK(isRefused([&] { simulator.removeBody(other); }));
  CHECK(isRefused([&] { simulator.world().addProbe("tip", id, Vec3::Zero()); }));
  CHECK_FALSE(simulator.archive().restore(Checkpoint()));
}

namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

double energy(const Body &body) {
  const ElasticEnergy elastic = body.elasticEnergy();
  return elastic.strain + elastic.stabilisation + body.kineticEnergy();
}

constexpr double kBarHeight = 0.04;  // m

/// A bar along x whose end at x = 0 is held.
std::unique_ptr<Body> heldBar(double length, double spacing) {
  BodyRecipe recipe{.fixes = {{.region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}}}};
  recipe.sampling.spacing = spacing;
  return shapes::makeBody(shapes::restState(shapes::box(Vec3::Zero(), Vec3(length, kBarHeight, kBarHeight)), recipe),
                          {Material()});
}

}  // namespace

TEST_CASE("a simulation of the same bodies continues with the same bits", "[checkpoint][continuation]") {
  Material flowing;
  flowing.prony[0] = {0.3, 0.05};
  Simulator before;
  before.setWorld(falling());
  const std::size_t id = before.addBody(organ(flowing));
  step(before, 150);

  Simulator now;
  now.setWorld(falling());
  (void)now.addBody(organ({}, 0.05));
  const std::size_t other = now.addBody(organ(flowing));
  const auto continued = now.archive().continueFrom(before.archive(), Pairs{{id, other}});
  REQUIRE(continued);
  REQUIRE(continued->size() == 1);
  CHECK(continued->front().isSame);
  CHECK(continued->front().energyAfter == continued->front().energyBefore);
  CHECK(now.body(other)->state().displacements == before.body(id)->state().displacements);
  CHECK(now.body(other)->state().velocities == before.body(id)->state().velocities);
  CHECK(now.time() == before.time());
  CHECK(now.steps() == before.steps());
  step(now, 50);
  CHECK(now.stepper().stoppedBodies() == 0);
}

TEST_CASE("a body that is filled anew continues with the motion of the other one", "[checkpoint][continuation]") {
  // Bent under its weight, and still moving.
  Simulator before;
  before.setWorld({.gravity = Vec3(0, -9.81, 0)});
  const std::size_t id = before.addBody(heldBar(0.2, 0.01));
  step(before, 400);
  const Body &source = *before.body(id);
  const double largest = std::max_element(source.state().displacements.begin(), source.state().displacements.end(),
                                          [](const Vec3 &a, const Vec3 &b) { return a.norm() < b.norm(); })
                             ->norm();
  REQUIRE(largest > 0.002);
  const Vec3 middle(0.1, 0.5 * kBarHeight, 0.5 * kBarHeight);
  (void)before.world().addProbe("middle", id, middle);
  const Vec3 displacementBefore = before.world().probeState(before.world().probes().back()).position - middle;

  // Shorter, longer by several cells, and with other cells.
  for (const auto &[length, spacing] : {std::pair{0.17, 0.01}, std::pair{0.26, 0.01}, std::pair{0.2, 0.008}}) {
    INFO(length << " m, spacing " << spacing << " m");
    Simulator now;
    now.setWorld({.gravity = Vec3(0, -9.81, 0)});
    const std::size_t other = now.addBody(heldBar(length, spacing));
    const auto continued = now.archive().continueFrom(before.archive(), Pairs{{id, other}});
    REQUIRE(continued);
    CHECK_FALSE(continued->front().isSame);
    (void)now.world().addProbe("middle", other, middle);
    const Vec3 displacement = now.world().probeState(now.world().probes().back()).position - middle;
    // Linear interpolation of a bent shape: an error of the order (spacing / length)² of the displacement.
    CHECK((displacement - displacementBefore).norm() < 0.01 * displacementBefore.norm());
    CHECK(energy(*now.body(other)) == Approx(continued->front().energyAfter));
    CHECK(energy(source) == Approx(continued->front().energyBefore));
    for (std::size_t i = 0; i < now.body(other)->rest().phyxelCount(); ++i)
      REQUIRE(now.body(other)->state().displacements[i].norm() < 2.0 * largest);
    step(now, 200);
    CHECK(now.stepper().stoppedBodies() == 0);
  }
}

TEST_CASE("a body does not continue from one that cannot be compared with it", "[checkpoint][continuation]") {
  Simulator before, now;
  const std::size_t id = before.addBody(heldBar(0.2, 0.02)), other = now.addBody(heldBar(0.2, 0.02));
  step(now, 10);
  const std::uint64_t hash = now.stateHash();
  const auto refusal = [&](const Pairs &pairs) {
    const auto continued = now.archive().continueFrom(before.archive(), pairs);
    CHECK(now.stateHash() == hash);
    return continued ? std::string() : continued.error();
  };
  CHECK_THAT(refusal({{id, other + 1}}), Contains("do not exist"));
  CHECK_THAT(refusal({{id, other}, {id, other}}), Contains("twice"));
  before.world().setRigid(id, true);
  CHECK_THAT(refusal({{id, other}}), Contains("rigid in only one"));
  before.world().setRigid(id, false);
  before.setWorld({.integrator = Integrator::quasiStatic});
  CHECK_THAT(refusal({{id, other}}), Contains("quasi-static"));
}
