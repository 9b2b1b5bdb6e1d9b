// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/scene_to_abi.h"

#include "c3de/core/text.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::session;
using scene::SceneRegion;

namespace {

SceneRegion sphere(double radius) {
  SceneRegion region;
  region.kind = SceneRegion::Kind::sphere;
  region.a = {1, 2, 3};
  region.radius = radius;
  return region;
}

Vec3 vec(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

TEST_CASE("Regions keep their kind, points and radius") {
  SceneRegion region = sphere(0.5);
  region.b = {4, 5, 6};
  const std::pair<SceneRegion::Kind, std::uint32_t> kinds[] = {
      {SceneRegion::Kind::everywhere, C3DE_SIM_REGION_EVERYWHERE},
      {SceneRegion::Kind::box, C3DE_SIM_REGION_BOX},
      {SceneRegion::Kind::sphere, C3DE_SIM_REGION_SPHERE},
      {SceneRegion::Kind::halfSpace, C3DE_SIM_REGION_HALF_SPACE}};
  for (const auto &[kind, abi] : kinds) {
    region.kind = kind;
    const c3de_sim_region out = toAbi(region);
    CHECK(out.size == sizeof out);
    CHECK(out.kind == abi);
    CHECK(vec(out.a) == Vec3{1, 2, 3});
    CHECK(vec(out.b) == Vec3{4, 5, 6});
    CHECK(out.radius == 0.5);
  }
}

TEST_CASE("A motion says whether its centre was given") {
  scene::SceneMotion motion;
  motion.displacement_m = {0.1, 0.2, 0.3};
  motion.rotation_deg = {10, 20, 30};
  motion.ramp_s = 2.0;
  c3de_sim_motion out = toAbi(motion);
  CHECK(out.flags == 0);
  CHECK(vec(out.displacement_m) == Vec3{0.1, 0.2, 0.3});
  CHECK(vec(out.rotation_deg) == Vec3{10, 20, 30});
  CHECK(out.ramp_s == 2.0);
  motion.centre_m = Vec3{7, 8, 9};
  out = toAbi(motion);
  CHECK(out.flags == C3DE_SIM_HAS_CENTRE);
  CHECK(vec(out.centre_m) == Vec3{7, 8, 9});
}

TEST_CASE("A body gets its own fixes and loads with their numbers in the scene, its parts and refinements") {
  scene::SceneFile scene;
  scene.bodies.resize(2);
  scene::SceneBody &body = scene.bodies[1];
  scene.bodies[0].name = "liver";
  body.name = "spleen";
  body.velocity_m_s = {1, 0, 0};
  body.angularVelocity_rad_s = {0, 2, 0};
  for (const char *of : {"liver", "spleen", "spleen"}) {
    scene::SceneFix fix;
    fix.body = of;
    fix.name = "fix of " + fix.body;
    scene.fixes.push_back(fix);
    scene::SceneLoad load;
    load.body = of;
    scene.loads.push_back(load);
  }
  scene.fixes[2].region = sphere(0.2);
  scene.loads[1].pressure_Pa = 50.0;
  scene.loads[2].force_N = Vec3{0, 0, 3};
  scene.loads[2].follower = false;
  scene.loads[2].ramp_s = 0.5;
  body.parts.resize(1);
  body.parts[0].name = "cyst";
  body.parts[0].region = sphere(0.3);
  body.refinements.resize(1);
  body.refinements[0].spacing_m = 0.004;
  ParameterValue density;
  density.id = "material.density";
  density.num = 900.0;
  const std::vector<std::vector<ParameterValue>> partValues{{density}};

  const BodyTables tables(scene, body, partValues);
  c3de_sim_body out{};
  tables.fill(out);
  REQUIRE(out.fixes_n == 2);
  CHECK(out.fixes_stride == sizeof(c3de_sim_fix));
  CHECK(out.fixes[0].index == 1);
  CHECK(fromAbi(out.fixes[0].name) == "fix of spleen");
  CHECK(out.fixes[1].index == 2);
  CHECK(out.fixes[1].region->radius == 0.2);
  REQUIRE(out.loads_n == 2);
  CHECK(out.loads[0].index == 1);
  CHECK(out.loads[0].flags == C3DE_SIM_LOAD_PRESSURE);
  CHECK(out.loads[0].pressure_Pa == 50.0);
  CHECK(out.loads[1].index == 2);
  CHECK(out.loads[1].flags == C3DE_SIM_LOAD_DEAD);
  CHECK(vec(out.loads[1].force_N) == Vec3{0, 0, 3});
  CHECK(out.loads[1].ramp_s == 0.5);
  REQUIRE(out.parts_n == 1);
  CHECK(fromAbi(out.parts[0].name) == "cyst");
  CHECK(out.parts[0].region->radius == 0.3);
  REQUIRE(out.parts[0].params_n == 1);
  CHECK(fromAbi(out.parts[0].params[0].id) == "material.density");
  CHECK(out.parts[0].params[0].num == 900.0);
  REQUIRE(out.refinements_n == 1);
  CHECK(out.refinements[0].spacing_m == 0.004);
  CHECK(vec(out.velocity_m_s) == Vec3{1, 0, 0});
  CHECK(vec(out.angular_velocity_rad_s) == Vec3{0, 2, 0});

  // A body without any gets none, and no dangling pointer.
  scene::SceneBody bare;
  bare.name = "bare";
  const std::vector<std::vector<ParameterValue>> none;
  BodyTables(scene, bare, none).fill(out);
  CHECK(out.fixes == nullptr);
  CHECK(out.fixes_n + out.loads_n + out.parts_n + out.refinements_n == 0);
}

TEST_CASE("An error about a table of a body leads back to its line") {
  scene::SceneFile scene;
  scene.fixes.resize(3);
  scene.loads.resize(2);
  scene::SceneBody body;
  body.parts.resize(2);
  body.refinements.resize(1);
  scene.fixes[2].line = 12;
  scene.loads[0].line = 20;
  body.parts[1].line = 31;
  body.refinements[0].line = 40;
  CHECK(sceneLineOf(scene, body, {"x", "fix", 2, {}}) == 12);
  CHECK(sceneLineOf(scene, body, {"x", "load", 0, {}}) == 20);
  CHECK(sceneLineOf(scene, body, {"x", "part", 1, {}}) == 31);
  CHECK(sceneLineOf(scene, body, {"x", "refinement", 0, {}}) == 40);
  CHECK_FALSE(sceneLineOf(scene, body, {"x", "fix", 3, {}}));
  CHECK_FALSE(sceneLineOf(scene, body, {"fix 2: x", {}, 2, {}}));
  CHECK_FALSE(sceneLineOf(scene, body, {"x", "moon", 0, {}}));
}

TEST_CASE("A placement is angles, or a matrix in their place") {
  scene::ScenePlacement placement{{1, 2, 3}, {10, 20, 30}, 0.5, {}};
  c3de_sim_placement out = toAbi(placement);
  CHECK(out.size == sizeof out);
  CHECK(out.flags == 0);
  CHECK(vec(out.position_m) == Vec3{1, 2, 3});
  CHECK(vec(out.rotation_deg) == Vec3{10, 20, 30});
  CHECK(out.scale == 0.5);
  placement.matrix = kIdentity4;
  (*placement.matrix)[12] = 7.0;
  out = toAbi(placement);
  CHECK(out.flags == C3DE_SIM_PLACED_BY_MATRIX);
  CHECK(out.matrix[12] == 7.0);
  CHECK(out.matrix[15] == 1.0);
}

TEST_CASE("Grids go to a simulator in metres") {
  const imaging::VolumeGeometry geometry{{2, 3, 4}, {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 10, 20, 30, 1}};
  const c3de_sim_grid out = toAbi(geometry);
  CHECK(out.size == sizeof out);
  CHECK(out.points[0] == 2);
  CHECK(out.points[2] == 4);
  CHECK_THAT(out.step_i_m[2], WithinAbs(0.003, 1e-15));
  CHECK_THAT(out.step_j_m[0], WithinAbs(0.004, 1e-15));
  CHECK_THAT(out.step_k_m[1], WithinAbs(0.008, 1e-15));
  CHECK_THAT(out.origin_m[2], WithinAbs(0.03, 1e-15));
}
