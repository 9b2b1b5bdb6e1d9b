// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_states.h"

#include <algorithm>

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;
using c3de::test::ReportedBody;

namespace {

const geometry::PointArray *named(const std::vector<geometry::PointArray> &arrays, const std::string &name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const auto &a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

/// A cube that has moved by (1, 0, 0) m, with two points.
ReportedBody bodyWithPoints() {
  ReportedBody body = cubeBody(0.1, {0, 0, 0}, {1, 0, 0});
  body.name = "liver";
  body.points = 2;
  body.inside = {{"reference_position", "m", {0, 0, 0, 0.1, 0, 0}},
                 {"position", "m", {0, 0.002, 0, 0.1, 0, 0.003}},
                 {"velocity", "m/s", {1, 2, 3, 4, 5, 6}},
                 {"mass", "kg", {0.5, 0.25}},
                 {"deformation_gradient", "1", {1, 0, 0, 0.5, 1, 0, 0, 0, 1, -1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  return body;
}

Expected<std::vector<BodyState>> read(RecordingSimulator &simulator, BodyParts parts = BodyParts::skinAndInside,
                                      const std::string &text = {}) {
  return readBodyStates(simulator.object(), parts, [text] { return text; });
}

}  // namespace

TEST_CASE("Skins and points are told in millimetres, with their displacement and the units in the names") {
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints(), cubeBody(0.2, {0, 0, 0}, {0, 0, 0})};
  simulator.bodies[1].inside = simulator.bodies[0].inside;
  simulator.bodies[1].points = 2;
  const auto states = read(simulator);
  REQUIRE(states);
  REQUIRE(states->size() == 2);
  const BodyState &liver = states->front();
  CHECK(liver.name == "liver");
  REQUIRE(liver.skin.vertices.size() == 8);
  CHECK(norm(liver.skin.vertices.back() - Vec3{1100, 100, 100}) < 1e-9);
  CHECK(liver.skin.triangles.size() == 12);
  CHECK(liver.skin.triangles[1] == Triangle{1, 2, 3});
  REQUIRE(liver.skinArrays.size() == 1);
  CHECK(liver.skinArrays[0].name == "displacement [mm]");
  CHECK_THAT(liver.skinArrays[0].values[0], WithinAbs(1000.0, 1e-9));
  REQUIRE(liver.inside.points.size() == 2);
  CHECK(norm(liver.inside.points[1] - Vec3{100, 0, 3}) < 1e-9);
  const auto *moved = named(liver.inside.arrays, "displacement [mm]");
  REQUIRE(moved);
  CHECK_THAT(moved->values[1], WithinAbs(2.0, 1e-9));
  CHECK_THAT(moved->values[5], WithinAbs(3.0, 1e-9));
  const auto *velocity = named(liver.inside.arrays, "velocity [m/s]");
  REQUIRE(velocity);
  CHECK(velocity->values == std::vector<double>{1, 2, 3, 4, 5, 6});
  REQUIRE(named(liver.inside.arrays, "mass [kg]"));
}

TEST_CASE("Matrices are told row by row") {
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints()};
  const auto states = read(simulator);
  REQUIRE(states);
  const auto *gradient = named(states->front().inside.arrays, "deformation_gradient [1]");
  REQUIRE(gradient);
  CHECK(gradient->components == 9);
  // F(0, 1), the fourth number of the columns, is the second of the rows.
  CHECK(gradient->values[1] == 0.5);
  CHECK(gradient->values[3] == 0.0);
}

TEST_CASE("Fields are those of the simulator, with its names and units, and one that it does not read is left out") {
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints()};
  simulator.bodies[0].inside.push_back({"temperature", "K", {310, 311}});
  simulator.bodies[0].inside.push_back({"pair", "1", {1, 2, 3, 4}});  // two components: not an array type of VTK
  auto states = read(simulator);
  REQUIRE(states);
  const auto *temperature = named(states->front().inside.arrays, "temperature [K]");
  REQUIRE(temperature);
  CHECK(temperature->values == std::vector<double>{310, 311});
  CHECK_FALSE(named(states->front().inside.arrays, "pair [1]"));
  simulator.fail("enum_fields", C3DE_E_INTERNAL);
  states = read(simulator);
  REQUIRE(states);
  CHECK(named(states->front().inside.arrays, "displacement [mm]"));
}

TEST_CASE("Where skins alone are asked for, points are not read") {
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints()};
  simulator.fail("points", C3DE_E_INTERNAL);
  const auto states = read(simulator, BodyParts::skin);
  REQUIRE(states);
  CHECK(states->front().inside.points.empty());
  CHECK(states->front().skin.vertices.size() == 8);
}

TEST_CASE("A surface without triangles gives points alone, and triangles of another form or of no vertex are refused") {
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints()};
  simulator.fail("triangles", C3DE_E_UNSUPPORTED);
  auto states = read(simulator);
  REQUIRE(states);
  CHECK(states->front().skin.triangles.empty());
  simulator.failNowhere();
  simulator.triangleComponents = 4;
  states = read(simulator);
  REQUIRE_FALSE(states);
  CHECK(states.error().code == ErrorCode::plugin);
  CHECK_THAT(states.error().message, Contains("the triangles of 'liver' are not three u32 each"));
  simulator.triangleComponents = 3;
  simulator.bodies[0].triangles[4][1] = 8;
  states = read(simulator);
  REQUIRE_FALSE(states);
  CHECK_THAT(states.error().message, Contains("a triangle of 'liver' refers to vertex 8; there are 8"));
}

TEST_CASE("What a simulator does not give is named with the body and the reason it left") {
  struct Refusal {
    std::string function, text, message;
  };
  const Refusal refusals[] = {{"status", "", "does not give its status: status -17"},
                              {"body_at", "busy", "does not give body 0: busy"},
                              {"body_info", "", "does not give the name of a body: status -17"},
                              {"surface", "", "gives no positions of the surface of 'liver'"},
                              {"points", "", "gives no positions of the points of 'liver'"}};
  for (const Refusal &one : refusals) {
    RecordingSimulator simulator;
    simulator.bodies = {bodyWithPoints()};
    simulator.fail(one.function, C3DE_E_INTERNAL);
    const auto states = read(simulator, BodyParts::skinAndInside, one.text);
    REQUIRE_FALSE(states);
    CHECK(states.error().code == ErrorCode::plugin);
    CHECK_THAT(states.error().message, Contains(one.message));
  }
  RecordingSimulator simulator;
  simulator.bodies = {bodyWithPoints()};
  eraseField(simulator.bodies[0].inside, "position");
  CHECK_THAT(read(simulator).error().message, Contains("no positions of the points of 'liver'"));
  eraseField(simulator.bodies[0].skin, "reference_position");
  CHECK_THAT(read(simulator).error().message, Contains("no positions of the surface of 'liver'"));
}
