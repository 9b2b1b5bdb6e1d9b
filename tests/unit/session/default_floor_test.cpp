// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/default_floor.h"

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

// The largest extent is 0.4 m, along y.
const Bounds_m kBodies{{0.0, 1.0, 0.0}, {0.2, 1.4, 0.1}};

}  // namespace

TEST_CASE("The room has its floor a twentieth of the largest extent below, and space to fall and to bounce") {
  const Bounds_m room = wallsAround(kBodies);
  CHECK(norm(room.min - Vec3{-0.4, 0.98, -0.4}) < 1e-12);
  CHECK(norm(room.max - Vec3{0.6, 2.2, 0.5}) < 1e-12);
}

TEST_CASE("A camera is shown the bodies and the floor around where they come to lie") {
  const Bounds_m framed = framedWith(kBodies, wallsAround(kBodies));
  CHECK(norm(framed.min - Vec3{-0.12, 0.98, -0.12}) < 1e-12);
  CHECK(norm(framed.max - Vec3{0.32, 1.4, 0.22}) < 1e-12);
}

TEST_CASE("Bounds are those of all skins as they are now, and without a skin there are none") {
  RecordingSimulator simulator;
  CHECK_FALSE(boundsOfBodies(simulator.object()));
  simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {1, 0, 0}), cubeBody(0.2, {0, 3, 0}, {0, 0, -1})};
  const auto bounds = boundsOfBodies(simulator.object());
  REQUIRE(bounds);
  CHECK(norm(bounds->min - Vec3{0, 0, -1}) < 1e-12);
  CHECK(norm(bounds->max - Vec3{1.1, 3.2, 0.1}) < 1e-12);
  simulator.bodies.resize(1);
  simulator.fail("surface", C3DE_E_INTERNAL);
  CHECK_FALSE(boundsOfBodies(simulator.object()));
}

TEST_CASE("Walls are put up where the simulator declares them and they fit") {
  RecordingSimulator simulator;
  auto room = addSurroundingWalls(simulator.object(), kBodies);
  REQUIRE(room);
  CHECK_FALSE(*room);
  CHECK(simulator.world.empty());

  simulator.worldIds = {"world.box.min", "world.box.max", "world.box.enabled"};
  room = addSurroundingWalls(simulator.object(), kBodies);
  REQUIRE(room);
  REQUIRE(*room);
  CHECK((*room)->min == wallsAround(kBodies).min);
  REQUIRE(simulator.world.size() == 3);
  CHECK(simulator.world[0].id == "world.box.min");
  CHECK(simulator.world[0].vec == wallsAround(kBodies).min);
  CHECK(simulator.world[1].vec == wallsAround(kBodies).max);
  CHECK(simulator.world[2].id == "world.box.enabled");
  CHECK(simulator.world[2].num == 1.0);

  // Larger than the accepted maximum of 10 m: it falls as before.
  simulator.world.clear();
  room = addSurroundingWalls(simulator.object(), {{0, 0, 0}, {6, 6, 6}});
  REQUIRE(room);
  CHECK_FALSE(*room);
  CHECK(simulator.world.empty());

  simulator.fail("set_world", C3DE_E_STATE);
  room = addSurroundingWalls(simulator.object(), kBodies);
  REQUIRE_FALSE(room);
  CHECK(room.error().code == ErrorCode::plugin);
  CHECK_THAT(room.error().message, Contains("refused the walls (status -7)"));
}
