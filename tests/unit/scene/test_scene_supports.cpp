// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "scene_text.h"

using namespace c3de;
using scene::SceneRegion;

TEST_CASE("Fixes are read with region, motion and name, and belong to the only body") {
  const auto scene = parse(kMinimal + R"([[fix]]
region = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }
[[fix]]
name = "grip"
body = "beam"
region = { half_space = { point = [0.1, 0, 0], normal = [-2, 0, 0] } }
displacement = [0, 0, 0.01]
rotation_deg = [0, 90, 0]
centre = [0.1, 0.2, 0.3]
ramp = 0.25
)");
  REQUIRE(scene.has_value());
  REQUIRE(scene->fixes.size() == 2);
  const scene::SceneFix &still = scene->fixes[0];
  CHECK(still.body == "beam");
  CHECK(still.name.empty());
  CHECK(still.line == 5);
  CHECK(still.region.kind == SceneRegion::Kind::box);
  CHECK(still.region.a == Vec3{-0.001, -1, -1});
  CHECK(still.region.b == Vec3{0.001, 1, 1});
  CHECK(still.motion.displacement_m == Vec3{});
  CHECK(still.motion.ramp_s == 0.0);
  CHECK_FALSE(still.motion.centre_m.has_value());
  const scene::SceneFix &grip = scene->fixes[1];
  CHECK(grip.name == "grip");
  CHECK(grip.line == 7);
  CHECK(grip.region.kind == SceneRegion::Kind::halfSpace);
  CHECK(grip.region.a == Vec3{0.1, 0, 0});
  CHECK(grip.region.b == Vec3{-2, 0, 0});
  CHECK(grip.motion.displacement_m == Vec3{0, 0, 0.01});
  CHECK(grip.motion.rotation_deg == Vec3{0, 90, 0});
  CHECK(grip.motion.centre_m == Vec3{0.1, 0.2, 0.3});
  CHECK(grip.motion.ramp_s == 0.25);
}

TEST_CASE("A load is a force or a pressure that follows the surface unless it says otherwise") {
  const auto scene = parse(kMinimal + R"([[load]]
region = { everywhere = true }
force = [0, -0.01, 0]
ramp = 0.5
[[load]]
name = "press"
region = { sphere = { centre = [1, 2, 3], radius = 0.5 } }
pressure = 200
[[load]]
region = { everywhere = true }
pressure = -5.5
follower = false
)");
  REQUIRE(scene.has_value());
  REQUIRE(scene->loads.size() == 3);
  CHECK(scene->loads[0].force_N == Vec3{0, -0.01, 0});
  CHECK_FALSE(scene->loads[0].pressure_Pa.has_value());
  CHECK(scene->loads[0].ramp_s == 0.5);
  CHECK(scene->loads[0].region.kind == SceneRegion::Kind::everywhere);
  CHECK(scene->loads[1].name == "press");
  CHECK(scene->loads[1].pressure_Pa == 200.0);
  CHECK(scene->loads[1].follower);
  CHECK(scene->loads[1].region.kind == SceneRegion::Kind::sphere);
  CHECK(scene->loads[1].region.a == Vec3{1, 2, 3});
  CHECK(scene->loads[1].region.radius == 0.5);
  CHECK(scene->loads[1].line == 9);
  CHECK(scene->loads[2].pressure_Pa == -5.5);
  CHECK_FALSE(scene->loads[2].follower);
  CHECK(scene->loads[2].body == "beam");
}

TEST_CASE("A fix may stand before the body it speaks of") {
  const auto scene = parse(
      "format = 1\n[[fix]]\nregion = { everywhere = true }\nbody = \"late\"\n[[body]]\nname = \"late\"\n"
      "mesh = \"beam.obj\"\nmesh_unit = \"m\"\n");
  REQUIRE(scene.has_value());
  CHECK(scene->fixes[0].body == "late");
}

TEST_CASE("An obstacle stands still unless it is given a motion") {
  const auto scene = parse(kMinimal + R"([[obstacle]]
mesh = "block.obj"
mesh_unit = "m"
rotation_deg = [0, 0, 30]
[[obstacle]]
name = "press"
mesh = "block.obj"
mesh_unit = "m"
displacement = [0, -0.02, 0]
motion_rotation_deg = [0, 45, 0]
centre = [1, 1, 1]
ramp = 2
)");
  REQUIRE(scene.has_value());
  CHECK_FALSE(scene->obstacles[0].motion.has_value());
  CHECK(scene->obstacles[0].placement.rotation_deg == Vec3{0, 0, 30});
  REQUIRE(scene->obstacles[1].motion.has_value());
  const scene::SceneMotion &motion = *scene->obstacles[1].motion;
  CHECK(motion.displacement_m == Vec3{0, -0.02, 0});
  CHECK(motion.rotation_deg == Vec3{0, 45, 0});
  CHECK(motion.centre_m == Vec3{1, 1, 1});
  CHECK(motion.ramp_s == 2.0);
  CHECK(scene->obstacles[1].placement.rotation_deg == Vec3{});
}

TEST_CASE("A body may have a velocity, parts of other materials and finer sampling") {
  const auto scene = parse(kMinimal + R"(velocity = [1, 2, 3]
angular_velocity = [0, 0, 6.28]
material = "liver"
parts = [ { region = { sphere = { centre = [0, 0, 0], radius = 0.01 } }, material = { preset = "liver", youngs_modulus = 5e4 } },
          { region = { everywhere = true }, material = "fat" } ]
sampling = { evaluation = "stress_points", spacing = 0.01, surface_spacing = 0.004, jitter = 0.1, stabilisation = 0.2, refine = [ { region = { everywhere = true }, spacing = 0.005 } ] }

[[body.parts]]
)");
  // The inline list is closed: a table cannot be added to it.
  REQUIRE_FALSE(scene.has_value());
  const auto good = parse(kMinimal + R"(velocity = [1, 2, 3]
angular_velocity = [0, 0, 6.28]
material = "liver"
sampling = { evaluation = "stress_points", spacing = 0.01, surface_spacing = 0.004, jitter = 0.1, stabilisation = 0.2, refine = [ { region = { everywhere = true }, spacing = 0.005 } ] }

[[body.parts]]
region = { sphere = { centre = [0, 0, 0], radius = 0.01 } }
material = { preset = "liver", youngs_modulus = 5e4, plastic = { yield = 0.1 } }

[[body.parts]]
region = { everywhere = true }
material = "fat"
)");
  REQUIRE(good.has_value());
  const scene::SceneBody &body = good->bodies[0];
  CHECK(body.velocity_m_s == Vec3{1, 2, 3});
  CHECK(body.angularVelocity_rad_s == Vec3{0, 0, 6.28});
  REQUIRE(body.parts.size() == 2);
  CHECK(body.parts[0].line == 10);
  CHECK(body.parts[0].region.radius == 0.01);
  CHECK(findValue(body.parts[0].params, "material.youngs_modulus")->value.num == 5e4);
  CHECK(findValue(body.parts[0].params, "material.density")->value.num == 1060.0);
  CHECK(findValue(body.parts[0].params, "material.plastic.yield")->value.num == 0.1);
  CHECK(findValue(body.parts[1].params, "material.density")->value.num == 950.0);
  CHECK(findValue(body.params, "material.youngs_modulus")->value.num == 6000.0);
  REQUIRE(body.refinements.size() == 1);
  CHECK(body.refinements[0].spacing_m == 0.005);
  CHECK(body.refinements[0].line == 8);
  CHECK(findValue(body.params, "sampling.evaluation")->value.text == "stress_points");
  CHECK(findValue(body.params, "sampling.jitter")->value.num == 0.1);
  CHECK(findValue(body.params, "sampling.surface_spacing")->value.num == 0.004);
  CHECK(findValue(body.params, "sampling.refine") == nullptr);
}

TEST_CASE("Plastic limits may be infinite and Prony terms become numbered ids") {
  const auto scene = parse(
      kMinimal +
      R"(material = { law = "corotated", volume_stiffness = 0.5, plastic = { yield = inf, creep = 0.1, creep_time = 2, max = +inf }, prony = [ { share = 0.3, time = 0.1 }, { share = 0.2, time = 1 } ] }
)");
  REQUIRE(scene.has_value());
  const auto value = [&](const char *id) { return findValue(scene->bodies[0].params, id)->value; };
  CHECK(value("material.law").text == "corotated");
  CHECK(value("material.volume_stiffness").num == 0.5);
  CHECK(std::isinf(value("material.plastic.yield").num));
  CHECK(value("material.plastic.yield").type == C3DE_PARAM_F64);
  CHECK(std::isinf(value("material.plastic.max").num));
  CHECK(value("material.plastic.creep_time").num == 2.0);
  CHECK(value("material.prony1.share").num == 0.3);
  CHECK(value("material.prony1.time").num == 0.1);
  CHECK(value("material.prony2.share").num == 0.2);
  CHECK(value("material.prony2.time").num == 1.0);
  CHECK(findValue(scene->bodies[0].params, "material.prony") == nullptr);
}

TEST_CASE("Keys of the solver are handed on as they are") {
  const auto scene = parse(kMinimal +
                           "[solver]\nintegrator = \"quasistatic\"\ndt = 0.01\ntolerance_mm = 1e-3\nload_steps = 5\n"
                           "preconditioner = \"jacobi\"\n");
  REQUIRE(scene.has_value());
  CHECK(findValue(scene->world, "solver.integrator")->value.text == "quasistatic");
  CHECK(findValue(scene->world, "solver.tolerance_mm")->value.num == 1e-3);
  CHECK(findValue(scene->world, "solver.load_steps")->value.type == C3DE_PARAM_I64);
  CHECK(findValue(scene->world, "solver.preconditioner")->value.text == "jacobi");
  // The simulator decides whether they are supported.
  ParameterDecl damping;
  damping.id = "solver.damping";
  const auto fitted = scene::fitToDeclarations(*scene, {*findValue(scene->world, "solver.load_steps")}, {damping});
  REQUIRE_FALSE(fitted.has_value());
  CHECK_THAT(fitted.error().message, Contains("test.toml:9: ") && Contains("unknown key 'solver.load_steps'"));
}
