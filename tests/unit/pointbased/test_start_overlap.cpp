// SPDX-License-Identifier: Apache-2.0
// Overlaps before the first step: reported with their depth, and resolved or refused.
#include <algorithm>
#include <cmath>
#include <string>

#include "contact_cases.h"
#include "pointbased/probe_tool.h"
#include "shapes.h"
#include "support/catch.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;

namespace {

Obstacle tool(const Vec3 &at, double radius, double length = 0.0) {
  ProbeTool of{.name = "tool", .radius = radius, .length = length};
  const ToolPose place{.at = at, .axis = Vec3::UnitX()};
  of.path = {place, place};
  of.path.back().time = 1.0;
  auto built = obstacleOf(of);
  REQUIRE(built);
  return std::move(*built);
}

std::string textOf(const Simulator &simulator, const std::string &kind) {
  for (const SimulationEvent &event : simulator.diagnostics().events())
    if (event.kind == kind) return event.text;
  return {};
}

}  // namespace

TEST_CASE("a body around an obstacle does not begin, and the reason names the depth") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(ball(Vec3::Zero(), 0.06, 0.012, soft(5e3, 0.45), 24));
  SECTION("within it") {
    simulator.addObstacle(tool(Vec3(0.02, 0, 0), 0.015));
    REQUIRE_FALSE(simulator.step());
    // From its farther side: 60 - 5 mm.
    CHECK_THAT(textOf(simulator, "stopped"), Contains("'tool' begins 5"));
  }
  SECTION("a rod through it, thinner than a spacing") {
    simulator.addObstacle(tool(Vec3::Zero(), 0.004, 0.3));
    REQUIRE_FALSE(simulator.step());
    CHECK_THAT(textOf(simulator, "stopped"), Contains("'tool' begins"));
  }
  SECTION("a sheet that cuts it") {
    simulator.addObstacle(sheet(0.01, 0.5, 0.3));
    REQUIRE_FALSE(simulator.step());
    CHECK_THAT(textOf(simulator, "stopped"), Contains("'sheet' begins"));
  }
  SECTION("that is switched off for it") {
    const std::size_t obstacle = simulator.addObstacle(tool(Vec3(0.02, 0, 0), 0.015));
    const ContactPairSettings off{.enabled = false};
    simulator.world().setContactPair(id, obstacle, off);
    CHECK(simulator.step());
    CHECK(textOf(simulator, "overlap").empty());
  }
}

TEST_CASE("an obstacle that is half inside a body is led out on the side from which it came") {
  const Integrator integrator =
      GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld({.integrator = integrator});
  const std::size_t id = simulator.addBody(ball(Vec3::Zero(), 0.06, 0.012, soft(5e3, 0.45, 20.0), 24));
  const Vec3 at(0.055, 0, 0);
  simulator.addObstacle(tool(at, 0.015));
  double fastest = 0.0;
  const auto deepest = [&] {
    double depth = 0.0;
    for (const Vec3 &x : simulator.body(id)->contactPositions(serialFor()))
      depth = std::max(depth, 0.015 - (x - at).norm());
    return depth;
  };
  CHECK(deepest() > 0.005);
  while (simulator.time() < 0.6) {
    REQUIRE(simulator.step());
    for (const Vec3 &v : simulator.body(id)->state().velocities) fastest = std::max(fastest, v.norm());
  }
  CHECK_THAT(textOf(simulator, "overlap"), Contains("'tool' overlap 19.9 mm"));
  CHECK(deepest() < 2e-4);
  // All of it is on the side of the body: nothing has closed around the tool.
  double farthest = -1.0;
  for (const Vec3 &x : simulator.body(id)->contactPositions(serialFor()))
    if (Vec3(0, x[1], x[2]).norm() < 0.012) farthest = std::max(farthest, x[0]);
  CHECK(farthest < at[0]);
  CHECK(fastest < 1.0);
}

TEST_CASE("two bodies in one place do not begin, and the reason names the depth") {
  Simulator simulator;
  simulator.world().setContact({true, false, 0.3});
  SECTION("alike") {
    for (int k = 0; k < 2; ++k) simulator.addBody(block(Vec3::Zero(), Vec3::Constant(0.05), 0.0125, soft(1e4, 0.3), 6));
  }
  SECTION("nearly") {
    simulator.addBody(block(Vec3::Zero(), Vec3::Constant(0.05), 0.0125, soft(1e4, 0.3), 6));
    simulator.addBody(block(Vec3(0.004, 0, 0.001), Vec3(0.054, 0.05, 0.051), 0.01, soft(1e4, 0.3), 5));
  }
  SECTION("one in the other") {
    simulator.addBody(block(Vec3::Zero(), Vec3::Constant(0.05), 0.0125, soft(1e4, 0.3), 6));
    simulator.addBody(ball(Vec3(0.02, 0.025, 0.025), 0.015, 0.005, soft(1e4, 0.3), 12));
  }
  REQUIRE_FALSE(simulator.step());
  CHECK(simulator.stepper().stoppedBodies() == 2);
  CHECK_THAT(textOf(simulator, "stopped"), Contains("begins in the same place") && Contains("mm"));
}

TEST_CASE("bodies and obstacles that touch at the start begin as they are") {
  Simulator simulator;
  simulator.addBody(block(Vec3::Zero(), Vec3::Constant(0.05), 0.0125, soft(1e4, 0.3), 6));
  simulator.addBody(block(Vec3(0, 0.05, 0), Vec3(0.05, 0.1, 0.05), 0.0125, soft(1e4, 0.3), 6));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  simulator.addObstacle(solidBox(Vec3(0.05, 0, 0), Vec3(0.1, 0.1, 0.05), 0.3));
  REQUIRE(simulator.step());
  CHECK(textOf(simulator, "overlap").empty());
  CHECK(simulator.stepper().stoppedBodies() == 0);
}
