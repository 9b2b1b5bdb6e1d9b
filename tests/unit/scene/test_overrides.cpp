// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "scene_text.h"

using namespace c3de;

namespace {

scene::SceneFile liverScene() {
  return parse(R"(format = 1
[[body]]
name = "liver"
mesh = "beam.obj"
mesh_unit = "m"
material = "liver"
sampling = { spacing = 0.01 }
[[body]]
name = "liver.left"
mesh = "beam.obj"
mesh_unit = "m"
parts = [ { region = { sphere = { centre = [0, 0, 0], radius = 0.1 } }, material = "fat" } ]
[[obstacle]]
name = "floor"
mesh = "block.obj"
mesh_unit = "m"
[[fix]]
name = "root"
body = "liver"
region = { everywhere = true }
[[fix]]
body = "liver.left"
region = { everywhere = true }
[[load]]
body = "liver"
region = { everywhere = true }
force = [0, 0, 1]
[[probe]]
name = "tip"
body = "liver"
at = [0, 0, 0]
)")
      .value();
}

}  // namespace

TEST_CASE("An override replaces what the scene says, and says where it came from") {
  scene::SceneFile scene = liverScene();
  REQUIRE(scene::applyOverride(scene, "body.liver.material.youngs_modulus=8e3", &presets()).has_value());
  const auto *modulus = findValue(scene.bodies[0].params, "material.youngs_modulus");
  CHECK(modulus->value.num == 8000.0);
  CHECK(scene.where(*modulus) == "--set body.liver.material.youngs_modulus");

  REQUIRE(scene::applyOverride(scene, "world.gravity=[0,-9.81,0]", nullptr).has_value());
  CHECK(findValue(scene.world, "world.gravity")->value.vec == Vec3{0.0, -9.81, 0.0});
  REQUIRE(scene::applyOverride(scene, "solver.dt=auto", nullptr).has_value());
  CHECK(findValue(scene.world, "solver.dt")->value.text == "auto");
  REQUIRE(scene::applyOverride(scene, "solver.dt = 1e-3", nullptr).has_value());
  CHECK(findValue(scene.world, "solver.dt")->value.num == 1e-3);
  REQUIRE(scene::applyOverride(scene, "obstacle.floor.friction=.5", nullptr).has_value());
  CHECK(findValue(scene.obstacles[0].params, "friction")->value.num == 0.5);
  REQUIRE(scene::applyOverride(scene, "obstacle.0.friction=0.25", nullptr).has_value());
  CHECK(findValue(scene.obstacles[0].params, "friction")->value.num == 0.25);
  REQUIRE(scene::applyOverride(scene, "body.liver.position=[0, 1, 0]", nullptr).has_value());
  CHECK(scene.bodies[0].placement.position_m == Vec3{0, 1, 0});
  REQUIRE(scene::applyOverride(scene, "body.liver.left.material=fat", &presets()).has_value());
  CHECK(findValue(scene.bodies[1].params, "material.density")->value.num == 950.0);
  REQUIRE(scene::applyOverride(scene, "probe.tip.at=[1,2,3]", nullptr).has_value());
  CHECK(scene.probes[0].at_m == Vec3{1, 2, 3});
  REQUIRE(scene::applyOverride(scene, "title=Second", nullptr).has_value());
  CHECK(scene.title == "Second");
}

TEST_CASE("Fixes, loads, moving obstacles and parts are overridden by name or number") {
  scene::SceneFile scene = liverScene();
  const auto set = [&](const char *assignment) {
    INFO(assignment);
    const auto applied = scene::applyOverride(scene, assignment, &presets());
    INFO((applied ? "" : applied.error().message));
    CHECK(applied.has_value());
  };
  set("fix.root.displacement=[0, 0, 0.01]");
  CHECK(scene.fixes[0].motion.displacement_m == Vec3{0, 0, 0.01});
  set("fix.1.rotation_deg=[0, 90, 0]");
  CHECK(scene.fixes[1].motion.rotation_deg == Vec3{0, 90, 0});
  set("fix.1.centre=[1, 0, 0]");
  CHECK(scene.fixes[1].motion.centre_m == Vec3{1, 0, 0});
  set("fix.0.ramp=0.5");
  CHECK(scene.fixes[0].motion.ramp_s == 0.5);
  set("fix.0.region={ sphere = { centre = [0, 0, 0], radius = 0.2 } }");
  CHECK(scene.fixes[0].region.radius == 0.2);
  set("load.0.force=[1, 2, 3]");
  CHECK(scene.loads[0].force_N == Vec3{1, 2, 3});
  set("load.0.pressure=250");
  CHECK(scene.loads[0].pressure_Pa == 250.0);
  CHECK_FALSE(scene.loads[0].force_N.has_value());
  set("load.0.follower=false");
  CHECK_FALSE(scene.loads[0].follower);
  set("load.0.force=[0, 1, 0]");
  CHECK_FALSE(scene.loads[0].pressure_Pa.has_value());
  CHECK(scene.loads[0].follower);
  set("obstacle.floor.displacement=[0, 0.1, 0]");
  REQUIRE(scene.obstacles[0].motion.has_value());
  CHECK(scene.obstacles[0].motion->displacement_m == Vec3{0, 0.1, 0});
  set("body.liver.velocity=[1, 0, 0]");
  CHECK(scene.bodies[0].velocity_m_s == Vec3{1, 0, 0});
  set("body.liver.left.parts.0.material.youngs_modulus=9e3");
  CHECK(findValue(scene.bodies[1].parts[0].params, "material.youngs_modulus")->value.num == 9e3);
  CHECK(findValue(scene.bodies[1].parts[0].params, "material.density")->value.num == 950.0);
}

TEST_CASE("Nested values of a material are overridden by their path") {
  scene::SceneFile scene = liverScene();
  for (const char *assignment : {"body.liver.material.plastic.yield=0.02", "body.liver.material.plastic.max=inf",
                                 "solver.integrator=quasistatic",
                                 "body.liver.material.prony=[ { share = 0.4, time = 2 }, { share = 0.1, time = 9 } ]",
                                 "body.liver.material.prony2.share=0.2",
                                 "body.liver.sampling.refine=[ { region = { everywhere = true }, spacing = 0.01 } ]"})
    CHECK(scene::applyOverride(scene, assignment, nullptr).has_value());
  const auto number = [&](const char *id) { return findValue(scene.bodies[0].params, id)->value.num; };
  CHECK(number("material.plastic.yield") == 0.02);
  CHECK(std::isinf(number("material.plastic.max")));
  CHECK(number("material.prony1.time") == 2.0);
  CHECK(number("material.prony2.share") == 0.2);
  CHECK(findValue(scene.world, "solver.integrator")->value.text == "quasistatic");
  CHECK(scene.bodies[0].refinements.size() == 1);
  // Fewer terms than before remove all old ones.
  REQUIRE(scene::applyOverride(scene, "body.liver.material.prony=[ { share = 0.5, time = 1 } ]", nullptr).has_value());
  CHECK(findValue(scene.bodies[0].params, "material.prony2.share") == nullptr);
}

TEST_CASE("An override of what a body is made from counts, or is refused") {
  const auto made = parse("format = 1\n[[body]]\nname = \"liver\"\nvolume = \".\"\nlabel = 5\n");
  REQUIRE(made.has_value());
  scene::SceneFile scene = *made;
  REQUIRE(scene::applyOverride(scene, "body.liver.label=spleen", nullptr).has_value());
  CHECK(scene.bodies[0].volume.labelName == "spleen");
  CHECK_FALSE(scene.bodies[0].volume.label.has_value());
  REQUIRE(scene::applyOverride(scene, "body.liver.threshold=[1, 2]", nullptr).has_value());
  CHECK(scene.bodies[0].volume.labelName.empty());
  REQUIRE(scene::applyOverride(scene, "body.liver.label=7", nullptr).has_value());
  CHECK_FALSE(scene.bodies[0].volume.threshold.has_value());
  CHECK(scene.bodies[0].volume.label == 7);
  const auto mesh = scene::applyOverride(scene, "body.liver.mesh=beam.obj", nullptr);
  REQUIRE_FALSE(mesh.has_value());
  CHECK_THAT(mesh.error().message, Contains("'mesh' belongs to a body with a 'mesh'; this one has a 'volume'"));
  scene::SceneFile ofMesh = liverScene();
  const auto label = scene::applyOverride(ofMesh, "body.liver.label=5", nullptr);
  REQUIRE_FALSE(label.has_value());
  CHECK_THAT(label.error().message, Contains("'label' belongs to a body with a 'volume'; this one has a 'mesh'"));
}

TEST_CASE("An override of something that does not exist is a usage error that names the nearest") {
  const struct {
    const char *assignment, *contains;
  } cases[] = {
      {"body.livr.material.density=1", "did you mean 'liver'?"},
      {"wrld.gravity=[0,0,0]", "did you mean 'world.gravity'?"},
      {"bdy.liver.material.density=1000", "did you mean 'body.liver.material.density'?"},
      {"body.liver.scael=2", "did you mean 'scale'?"},
      {"obstacle.flor.friction=1", "did you mean 'floor'?"},
      {"obstacle.7.friction=1", "no obstacle '7'"},
      {"obstacle.floor.frction=1", "did you mean 'friction'?"},
      {"probe.tap.at=[0,0,0]", "did you mean 'tip'?"},
      {"body.liver.material=livr", "did you mean 'liver'?"},
      {"body.liver.scale=-1", "above 0"},
      {"body.liver.position=3", "[x, y, z]"},
      {"body.liver=3", "no key for body 'liver'"},
      {"world.box.min=[0,0,0]", "no 'max'"},
      {"fix.rot.ramp=1", "did you mean 'root'?"},
      {"fix.7.ramp=1", "no fix '7'"},
      {"fix.root.rmp=1", "did you mean 'ramp'?"},
      {"fix.root.ramp=-1", "at least 0"},
      {"fix.root.body=livr", "did you mean 'liver'?"},
      {"fix.root.name=foot", "cannot be changed"},
      {"load.0.follower=true", "the load has a force"},
      {"load.0.presure=1", "did you mean 'pressure'?"},
      {"load.3.pressure=1", "no load '3'"},
      {"body.liver.parts.0.material.density=1", "has 0"},
      {"body.liver.left.parts.0.materal=fat", "did you mean 'material'?"},
      {"no-equals-sign", "PATH=VALUE"},
      {"=3", "PATH=VALUE"},
  };
  for (const auto &one : cases) {
    INFO(one.assignment);
    scene::SceneFile scene = liverScene();
    const auto applied = scene::applyOverride(scene, one.assignment, &presets());
    REQUIRE_FALSE(applied.has_value());
    CHECK(applied.error().code == ErrorCode::usage);
    CHECK_THAT(applied.error().message, Contains("--set ") && Contains(one.contains));
    CHECK(scene.bodies[0].params.size() == liverScene().bodies[0].params.size());
  }
}

TEST_CASE("A value that the simulator does not know is a usage error when it came from the command line") {
  scene::SceneFile scene = liverScene();
  REQUIRE(scene::applyOverride(scene, "solver.dumping=1", nullptr).has_value());
  ParameterDecl damping;
  damping.id = "solver.damping";
  const auto fitted = scene::fitToDeclarations(scene, {scene.world.front()}, {damping});
  REQUIRE_FALSE(fitted.has_value());
  CHECK(fitted.error().code == ErrorCode::usage);
  CHECK_THAT(fitted.error().message, Contains("--set solver.dumping: ") && Contains("solver.damping"));
}

TEST_CASE("An override cannot smuggle in a second key") {
  scene::SceneFile scene = liverScene();
  REQUIRE(scene::applyOverride(scene, "title=1\nformat = 9", nullptr).has_value());
  CHECK(scene.title == "1\nformat = 9");
}
