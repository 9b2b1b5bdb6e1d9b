// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_states.h"

#include <algorithm>

#include "stand_in_simulator.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using session::test::cubeBody;
using session::test::StandInBody;
using session::test::StandInSimulator;

namespace {

const geometry::PointArray *named(const std::vector<geometry::PointArray> &arrays, const std::string &name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const auto &a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

/// A cube that has moved by (1, 0, 0) m, with two phyxels: one pulled along x by 300 Pa, one inverted.
StandInBody bodyWithPhyxels() {
  StandInBody body = cubeBody(0.1, {0, 0, 0}, {1, 0, 0});
  body.name = "liver";
  body.phyxels = 2;
  body.points = {{C3DE_FIELD_REFERENCE_POSITION, {0, 0, 0, 0.1, 0, 0}},
                 {C3DE_FIELD_POSITION, {0, 0.002, 0, 0.1, 0, 0.003}},
                 {C3DE_FIELD_VELOCITY, {1, 2, 3, 4, 5, 6}},
                 {C3DE_FIELD_MASS, {0.5, 0.25}},
                 {C3DE_FIELD_GRADIENT, {1, 0, 0, 0.5, 1, 0, 0, 0, 1, -1, 0, 0, 0, 1, 0, 0, 0, 1}},
                 {C3DE_FIELD_STRESS, {0, 0, 0, 0, 0, 0, 0, 0, 300, 300, 0, 0, 0, 0, 0, 0, 0, 0}}};
  return body;
}

Expected<std::vector<BodyState>> read(StandInSimulator &simulator, BodyParts parts = BodyParts::skinAndPhyxels,
                                      const std::string &text = {}) {
  return readBodyStates(simulator.object(), parts, [text] { return text; });
}

}  // namespace

TEST_CASE("Skins and phyxels are told in millimetres, with their displacement and the units in the names") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels(), cubeBody(0.2, {0, 0, 0}, {0, 0, 0})};
  simulator.bodies[1].points = simulator.bodies[0].points;
  simulator.bodies[1].phyxels = 2;
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
  REQUIRE(liver.phyxels.points.size() == 2);
  CHECK(norm(liver.phyxels.points[1] - Vec3{100, 0, 3}) < 1e-9);
  const auto *moved = named(liver.phyxels.arrays, "displacement [mm]");
  REQUIRE(moved);
  CHECK_THAT(moved->values[1], WithinAbs(2.0, 1e-9));
  CHECK_THAT(moved->values[5], WithinAbs(3.0, 1e-9));
  const auto *velocity = named(liver.phyxels.arrays, "velocity [m/s]");
  REQUIRE(velocity);
  CHECK(velocity->values == std::vector<double>{1, 2, 3, 4, 5, 6});
  REQUIRE(named(liver.phyxels.arrays, "mass [kg]"));
  CHECK(simulator.openSets == 0);
}

TEST_CASE("Matrices are told row by row, and von Mises stress is that of the Cauchy stress") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  const auto states = read(simulator);
  REQUIRE(states);
  const auto &arrays = states->front().phyxels.arrays;
  const auto *gradient = named(arrays, "deformation_gradient [1]");
  REQUIRE(gradient);
  CHECK(gradient->components == 9);
  // F(0, 1), the fourth number of the columns, is the second of the rows.
  CHECK(gradient->values[1] == 0.5);
  CHECK(gradient->values[3] == 0.0);
  const auto *mises = named(arrays, "stress_vm [Pa]");
  REQUIRE(mises);
  REQUIRE(mises->values.size() == 2);
  // Uniaxial along z, which the shear in x and y leaves alone, det F = 1; the other point is inverted.
  CHECK_THAT(mises->values[0], WithinAbs(300.0, 1e-9));
  CHECK(mises->values[1] == 0.0);
}

TEST_CASE("Von Mises stress of a stretched point follows F S F^T / det F") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  // Twice as long along x, 300 Pa in the reference: 300 * 2 * 2 / 2.
  simulator.bodies[0].points[C3DE_FIELD_GRADIENT] = {2, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  // And a pure shear of 100 Pa: the square root of three times as much.
  simulator.bodies[0].points[C3DE_FIELD_STRESS] = {300, 0, 0, 0, 0, 0, 0, 0, 0, 0, 100, 0, 100, 0, 0, 0, 0, 0};
  const auto states = read(simulator);
  REQUIRE(states);
  const auto *mises = named(states->front().phyxels.arrays, "stress_vm [Pa]");
  REQUIRE(mises);
  CHECK_THAT(mises->values[0], WithinAbs(600.0, 1e-9));
  CHECK_THAT(mises->values[1], WithinAbs(173.20508075688772, 1e-9));
}

TEST_CASE("Fields that a simulator does not offer are left out, and so is what follows from them") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  simulator.bodies[0].points.erase(C3DE_FIELD_GRADIENT);
  const auto states = read(simulator);
  REQUIRE(states);
  const auto &arrays = states->front().phyxels.arrays;
  CHECK(named(arrays, "stress_pk2 [Pa]"));
  CHECK_FALSE(named(arrays, "stress_vm [Pa]"));
  CHECK_FALSE(named(arrays, "deformation_gradient [1]"));
  CHECK_FALSE(named(arrays, "volume [m^3]"));
}

TEST_CASE("Where skins alone are asked for, phyxels are not read") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  simulator.failing["phyxels"] = C3DE_E_INTERNAL;
  const auto states = read(simulator, BodyParts::skin);
  REQUIRE(states);
  CHECK(states->front().phyxels.points.empty());
  CHECK(states->front().skin.vertices.size() == 8);
}

TEST_CASE("A surfel set that lends no triangles gives points alone, and triangles of another form are refused") {
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  simulator.setRevision = 1;
  auto states = read(simulator);
  REQUIRE(states);
  CHECK(states->front().skin.triangles.empty());
  simulator.setRevision = 2;
  simulator.failing["triangles"] = C3DE_E_UNSUPPORTED;
  states = read(simulator);
  REQUIRE(states);
  CHECK(states->front().skin.triangles.empty());
  simulator.failing.clear();
  simulator.triangleComponents = 4;
  states = read(simulator);
  REQUIRE_FALSE(states);
  CHECK(states.error().code == ErrorCode::plugin);
  CHECK_THAT(states.error().message, Contains("the triangles of 'liver' are not three u32 each"));
}

TEST_CASE("What a simulator does not give is named with the body and the reason it left") {
  struct Refusal {
    std::string function, text, message;
  };
  const Refusal refusals[] = {{"status", "", "does not give its status: status -17"},
                              {"body_at", "busy", "does not give body 0: busy"},
                              {"body_info", "", "does not give the name of a body: status -17"},
                              {"surfels", "no skin", "does not give the surface of 'liver': no skin"},
                              {"phyxels", "", "does not give the phyxels of 'liver': status -17"}};
  for (const Refusal &one : refusals) {
    StandInSimulator simulator;
    simulator.bodies = {bodyWithPhyxels()};
    simulator.failing[one.function] = C3DE_E_INTERNAL;
    const auto states = read(simulator, BodyParts::skinAndPhyxels, one.text);
    REQUIRE_FALSE(states);
    CHECK(states.error().code == ErrorCode::plugin);
    CHECK_THAT(states.error().message, Contains(one.message));
    CHECK(simulator.openSets == 0);
  }
  StandInSimulator simulator;
  simulator.bodies = {bodyWithPhyxels()};
  simulator.bodies[0].points.erase(C3DE_FIELD_POSITION);
  CHECK_THAT(read(simulator).error().message, Contains("no positions of the phyxels of 'liver'"));
  simulator.bodies[0].skin.erase(C3DE_FIELD_REFERENCE_POSITION);
  CHECK_THAT(read(simulator).error().message, Contains("no positions of the surface of 'liver'"));
  simulator.setsAnswer = false;
  CHECK_THAT(read(simulator).error().message, Contains("set does not answer " C3DE_IFACE_SURFEL_SET_ID));
}
