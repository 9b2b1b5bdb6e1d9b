// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulator_access.h"

#include <cstddef>

#include "c3de/core/text.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

TEST_CASE("An object without the table, or with one that is too short or lacks a slot, is refused with what it lacks") {
  RecordingSimulator simulator;
  const auto table = simulatorTable(simulator.object());
  REQUIRE(table);
  CHECK(*table == simulator.table());
  simulator.tableSize = 256;
  const auto small = simulatorTable(simulator.object());
  REQUIRE_FALSE(small);
  CHECK(small.error().code == ErrorCode::plugin);
  CHECK_THAT(small.error().message, Contains("member size is 256; at least 264 is required"));
  simulator.tableSize = sizeof(c3de_simulator_v1);
  simulator.lacksStateHash = true;
  const auto lacking = simulatorTable(simulator.object());
  REQUIRE_FALSE(lacking);
  CHECK_THAT(lacking.error().message,
             Contains("the object's table of " C3DE_IFACE_SIMULATOR_ID ": state_hash is null"));
  simulator.answersInterface = false;
  const auto none = simulatorTable(simulator.object());
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ErrorCode::plugin);
  CHECK_THAT(none.error().message, Contains("does not implement " C3DE_IFACE_SIMULATOR_ID " (status -5)"));
}

TEST_CASE("What a simulator can do follows from the slots that are not null") {
  RecordingSimulator all, none;
  none.hasDisplacement = none.hasInterrupt = false;
  CHECK(supportsFills(all.table()));
  CHECK(endsSteps(all.table()));
  CHECK_FALSE(supportsFills(none.table()));
  CHECK_FALSE(endsSteps(none.table()));
}

TEST_CASE("Who does not answer for contact serves none, and a table for it that cannot be called is refused") {
  RecordingSimulator simulator;
  const auto none = contactTable(simulator.object());
  REQUIRE(none);
  CHECK(*none == nullptr);
  CHECK(readProbeTools(simulator.object())->empty());

  c3de_contact_v1 table{};
  table.size = sizeof table;
  table.rev = 1;
  simulator.contact = &table;
  const auto lacking = contactTable(simulator.object());
  REQUIRE_FALSE(lacking);
  CHECK(lacking.error().code == ErrorCode::plugin);
  CHECK_THAT(lacking.error().message, Contains(C3DE_IFACE_CONTACT_ID ": set_pair is null"));

  table.set_pair = [](c3de_object *, const c3de_sim_contact_pair *) -> c3de_status { return C3DE_OK; };
  const auto pairs = contactTable(simulator.object());
  REQUIRE(pairs);
  CHECK(*pairs == &table);
  CHECK(readProbeTools(simulator.object())->empty());

  table.enum_probe_tools = [](c3de_object *, void *visitor,
                              c3de_status(C3DE_CALL * each)(void *, const c3de_sim_probe_tool_state *)) -> c3de_status {
    c3de_sim_probe_tool_state state{};
    state.size = sizeof state;
    state.name = toAbi("finger");
    state.force_N[1] = 2.5;
    return each(visitor, &state);
  };
  CHECK_THAT(contactTable(simulator.object()).error().message, Contains("both, or null for both"));
  table.add_probe_tool = [](c3de_object *, const c3de_sim_probe_tool *, c3de_handle *) -> c3de_status {
    return C3DE_OK;
  };
  const auto tools = readProbeTools(simulator.object());
  REQUIRE(tools);
  REQUIRE(tools->size() == 1);
  CHECK(tools->front().name == "finger");
  CHECK(tools->front().force_N == Vec3{0, 2.5, 0});
}

TEST_CASE("Declarations are those of the scope, and a simulator that does not say them is named with it") {
  RecordingSimulator simulator;
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
  simulator.fail("declarations", C3DE_E_INTERNAL);
  const auto refused = simulatorDeclarations(simulator.object(), C3DE_SIM_SCOPE_OBSTACLE);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::plugin);
  CHECK_THAT(refused.error().message, Contains("scope 3 (status -17)"));
}

TEST_CASE("The surface of a body is where it is now, in metres") {
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {1, 2, 3})};
  const std::vector<Vec3> x = surfacePositions(simulator.object(), {1});
  REQUIRE(x.size() == 8);
  CHECK(norm(x.front() - Vec3{1, 2, 3}) < 1e-12);
  CHECK(norm(x.back() - Vec3{1.1, 2.1, 3.1}) < 1e-12);
  CHECK(surfacePositions(simulator.object(), {7}).empty());
  eraseField(simulator.bodies.front().skin, "position");
  CHECK(surfacePositions(simulator.object(), {1}).empty());
}

TEST_CASE("Probes are read with name and position, and a simulator that does not say them is an error") {
  RecordingSimulator simulator;
  simulator.probes = {{"tip", {1, 2, 3}}, {"root", {0, 0, 4}}};
  const auto probes = readProbes(simulator.table(), simulator.object());
  REQUIRE(probes);
  REQUIRE(probes->size() == 2);
  CHECK((*probes)[0].name == "tip");
  CHECK((*probes)[0].position_m == Vec3{1, 2, 3});
  CHECK((*probes)[1].name == "root");
  simulator.fail("enum_probes", C3DE_E_INTERNAL);
  const auto refused = readProbes(simulator.table(), simulator.object());
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::plugin);
}

TEST_CASE("An object reference gives back the one count it took over, however it moves") {
  RecordingSimulator first, second;
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
