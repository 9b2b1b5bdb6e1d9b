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
