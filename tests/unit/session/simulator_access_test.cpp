// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulator_access.h"

#include <cstddef>

#include "stand_in_simulator.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using session::test::cubeBody;
using session::test::StandInSimulator;

TEST_CASE("A simulator's table is had from revision 1 on, and an object without one is refused with what it lacks") {
  StandInSimulator simulator;
  simulator.tableSize = offsetof(c3de_simulator_v0, displacement);
  const auto table = simulatorTable(simulator.object());
  REQUIRE(table);
  CHECK(*table == simulator.table());
  simulator.tableSize -= 8;
  const auto small = simulatorTable(simulator.object());
  REQUIRE_FALSE(small);
  CHECK(small.error().code == ErrorCode::plugin);
  CHECK_THAT(small.error().message, Contains(std::to_string(simulator.tableSize) + " bytes; needed: " +
                                             std::to_string(offsetof(c3de_simulator_v0, displacement))));
  simulator.answersInterface = false;
  const auto none = simulatorTable(simulator.object());
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ErrorCode::plugin);
  CHECK_THAT(none.error().message, Contains("does not answer " C3DE_IFACE_SIMULATOR_ID " (status -5)"));
}

TEST_CASE("What a simulator can do follows from its revision and the size of its table") {
  StandInSimulator simulator;
  CHECK(servesFills(simulator.table()));
  CHECK(endsSteps(simulator.table()));
  simulator.revision = 3;
  CHECK(servesFills(simulator.table()));
  CHECK_FALSE(endsSteps(simulator.table()));
  simulator.revision = 2;
  CHECK_FALSE(servesFills(simulator.table()));
  simulator.revision = 4;
  simulator.tableSize = offsetof(c3de_simulator_v0, interrupt);
  CHECK(servesFills(simulator.table()));
  CHECK_FALSE(endsSteps(simulator.table()));
  simulator.tableSize = offsetof(c3de_simulator_v0, displacement);
  CHECK_FALSE(servesFills(simulator.table()));
}

TEST_CASE("Declarations are those of the scope, and a simulator that does not say them is named with it") {
  StandInSimulator simulator;
  simulator.worldIds = {"solver.dt"};
  simulator.bodyIds = {"material.density", "material.poisson_ratio"};
  const auto world = simulatorDeclarations(simulator.object(), C3DE_SIM_SCOPE_WORLD);
  const auto body = simulatorDeclarations(simulator.object(), C3DE_SIM_SCOPE_BODY);
  REQUIRE(world);
  REQUIRE(body);
  REQUIRE(world->size() == 1);
  CHECK(world->front().id == "solver.dt");
  REQUIRE(body->size() == 2);
  CHECK(body->back().id == "material.poisson_ratio");
  simulator.failing["declarations"] = C3DE_E_INTERNAL;
  const auto refused = simulatorDeclarations(simulator.object(), C3DE_SIM_SCOPE_OBSTACLE);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::plugin);
  CHECK_THAT(refused.error().message, Contains("scope 3 (status -17)"));
}

TEST_CASE("Surfels of a body are where they are now, in metres, and their set is given back") {
  StandInSimulator simulator;
  simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {1, 2, 3})};
  const std::vector<Vec3> x = surfelPositions(simulator.object(), {1});
  REQUIRE(x.size() == 8);
  CHECK(norm(x.front() - Vec3{1, 2, 3}) < 1e-12);
  CHECK(norm(x.back() - Vec3{1.1, 2.1, 3.1}) < 1e-12);
  CHECK(surfelPositions(simulator.object(), {7}).empty());
  simulator.bodies.front().skin.erase(C3DE_FIELD_POSITION);
  CHECK(surfelPositions(simulator.object(), {1}).empty());
  simulator.setsAnswer = false;
  CHECK(surfelPositions(simulator.object(), {1}).empty());
  CHECK(simulator.openSets == 0);
}

TEST_CASE("An object reference gives back the one count it took over, however it moves") {
  StandInSimulator first, second;
  {
    first.object()->vt->retain(first.object());
    second.object()->vt->retain(second.object());
    ObjectRef a(first.object());
    ObjectRef b(std::move(a));
    CHECK(b.get() == first.object());
    CHECK(a.get() == nullptr);  // NOLINT(bugprone-use-after-move): it is empty
    b = ObjectRef(second.object());
    CHECK(b.get() == second.object());
    CHECK(first.references() == 1);
    CHECK(second.references() == 2);
  }
  CHECK(first.references() == 1);
  CHECK(second.references() == 1);
}
