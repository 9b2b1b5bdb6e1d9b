// SPDX-License-Identifier: Apache-2.0
#include "scene_text.h"

using namespace c3de;

TEST_CASE("A scene with everything that is served is read with its lines") {
  const auto scene = parse(R"(format = 1
title = "Beam"

[world]
gravity = [0.0, -9.81, 0]
box = { min = [-1, -1, -1], max = [1.0, 1.0, 1.0] }

[solver]
integrator = "explicit"
dt = "auto"
damping = 0.5

[[body]]
name = "beam"
mesh = "beam.obj"
mesh_unit = "cm"
position = [1, 2, 3]
rotation_deg = [0, 90, 0]
scale = 2
material = { law = "neo_hookean", youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1000.0 }
sampling = { spacing = 0.01, neighbours = 26 }

[[obstacle]]
mesh = "block.obj"
mesh_unit = "mm"
friction = 0.3

[[probe]]
name = "tip"
body = "beam"
at = [0.2, 0.02, 0.02]
)");
  REQUIRE(scene.has_value());
  CHECK(scene->title == "Beam");
  const auto *gravity = findValue(scene->world, "world.gravity");
  REQUIRE(gravity != nullptr);
  CHECK(gravity->value.vec == Vec3{0.0, -9.81, 0.0});
  CHECK(gravity->line == 5);
  CHECK(scene->where(*gravity) == scene->source.string() + ":5");
  CHECK(findValue(scene->world, "world.box.min")->value.vec == Vec3{-1, -1, -1});
  CHECK(findValue(scene->world, "world.box.enabled")->value.num == 1.0);
  CHECK(findValue(scene->world, "solver.dt")->value.text == "auto");

  REQUIRE(scene->bodies.size() == 1);
  const scene::SceneBody &body = scene->bodies.front();
  CHECK(body.name == "beam");
  CHECK(body.line == 13);
  CHECK(body.mesh.filename() == "beam.obj");
  CHECK(body.meshUnit == geometry::LengthUnit::centimetre);
  CHECK(body.placement.position_m == Vec3{1, 2, 3});
  CHECK(body.placement.rotation_deg == Vec3{0, 90, 0});
  CHECK(body.placement.scale == 2.0);
  CHECK(findValue(body.params, "material.youngs_modulus")->value.num == 1e4);
  CHECK(findValue(body.params, "material.youngs_modulus")->line == 20);
  CHECK(findValue(body.params, "material.law")->value.text == "neo_hookean");
  CHECK(findValue(body.params, "sampling.neighbours")->value.num == 26.0);

  REQUIRE(scene->obstacles.size() == 1);
  CHECK(scene->obstacles.front().name == "block");
  CHECK(findValue(scene->obstacles.front().params, "friction")->value.num == 0.3);
  REQUIRE(scene->probes.size() == 1);
  CHECK(scene->probes.front().body == "beam");
  CHECK(scene->probes.front().at_m == Vec3{0.2, 0.02, 0.02});
}

TEST_CASE("What is left out of a scene is taken from the file names") {
  const auto scene = parse(kMinimal + "[[body]]\nmesh = \"beam.obj\"\nmesh_unit = \"m\"\n");
  REQUIRE(scene.has_value());
  CHECK(scene->title == "test");
  CHECK(scene->bodies[0].name == "beam");
  CHECK(scene->bodies[1].name == "beam-2");
  CHECK(scene->world.empty());
}

TEST_CASE("A material can be a preset, and what stands beside the preset counts") {
  const auto named = parse(kMinimal + "material = \"liver\"\n");
  REQUIRE(named.has_value());
  CHECK(findValue(named->bodies[0].params, "material.youngs_modulus")->value.num == 6000.0);
  CHECK(findValue(named->bodies[0].params, "material.density")->value.num == 1060.0);
  CHECK(findValue(named->bodies[0].params, "material.poisson_ratio")->value.num == 0.49);

  const auto changed = parse(kMinimal + "material = { youngs_modulus = 8e3, preset = \"liver\" }\n");
  REQUIRE(changed.has_value());
  CHECK(findValue(changed->bodies[0].params, "material.youngs_modulus")->value.num == 8000.0);
  CHECK(findValue(changed->bodies[0].params, "material.density")->value.num == 1060.0);
  CHECK(changed->bodies[0].params.size() == 3);
}

TEST_CASE("Nested material tables become dotted ids") {
  const auto scene = parse(kMinimal + "material = { plastic = { yield = 0.1, max = 2 } }\n");
  REQUIRE(scene.has_value());
  CHECK(findValue(scene->bodies[0].params, "material.plastic.yield")->value.num == 0.1);
  CHECK(findValue(scene->bodies[0].params, "material.plastic.max")->value.type == C3DE_PARAM_I64);
}

TEST_CASE("A format that says its unit needs no mesh_unit") {
  const auto scene = parse("format = 1\n[[body]]\nmesh = \"model.glb\"\n");
  REQUIRE(scene.has_value());
  CHECK(scene->bodies[0].meshUnit == geometry::LengthUnit::metre);
}

TEST_CASE("A probe without a body belongs to the only one") {
  const auto scene = parse(kMinimal + "[[probe]]\nat = [0, 0, 0]\n");
  REQUIRE(scene.has_value());
  CHECK(scene->probes[0].body == "beam");
  CHECK(scene->probes[0].name == "probe-1");
}

TEST_CASE("A mesh becomes a scene of one body under gravity") {
  const auto scene = scene::sceneForMesh("some/liver.obj", geometry::LengthUnit::millimetre);
  CHECK(scene.title == "liver");
  REQUIRE(scene.bodies.size() == 1);
  CHECK(scene.bodies[0].name == "liver");
  CHECK(findValue(scene.world, "world.gravity")->value.vec == Vec3{0.0, -9.81, 0.0});
  CHECK(scene.where(0) == "liver");
}

TEST_CASE("A value is made what the simulator declares, or refused with its place") {
  const auto scene = parse(kMinimal + R"(material = { law = "stvk", density = 1000, youngs_modulus = -1.0, yungs = 3.0 }
sampling = { count = 1000.5 }
)");
  REQUIRE(scene.has_value());
  ParameterDecl density, law, modulus, count;
  density.id = "material.density";
  density.max = 1e5;
  law.id = "material.law";
  law.type = C3DE_PARAM_CHOICE;
  law.choices = {"stvk", "neo_hookean"};
  modulus.id = "material.youngs_modulus";
  modulus.max = 1e12;
  count.id = "sampling.count";
  count.type = C3DE_PARAM_I64;
  count.max = 1e6;
  const std::vector<ParameterDecl> decls{density, law, modulus, count};
  const auto fit = [&](const char *id) {
    return scene::fitToDeclaration(*scene, *findValue(scene->bodies[0].params, id), decls);
  };

  CHECK(fit("material.density").value().type == C3DE_PARAM_F64);
  CHECK(fit("material.law").value().type == C3DE_PARAM_CHOICE);
  const auto negative = fit("material.youngs_modulus");
  REQUIRE_FALSE(negative.has_value());
  CHECK(negative.error().code == ErrorCode::input);
  CHECK_THAT(negative.error().message,
             Contains("test.toml:5: ") && Contains("material.youngs_modulus") && Contains("-1"));
  const auto unknown = fit("material.yungs");
  REQUIRE_FALSE(unknown.has_value());
  CHECK_THAT(unknown.error().message, Contains("test.toml:5: ") && Contains("material.yungs"));
  const auto fraction = fit("sampling.count");
  REQUIRE_FALSE(fraction.has_value());
  CHECK_THAT(fraction.error().message, Contains("test.toml:6: "));
}

TEST_CASE("A key that the format knows and the simulator does not is refused as not served yet") {
  const auto scene = parse(kMinimal + "material = { plastic = { yield = 0.1 } }\n");
  REQUIRE(scene.has_value());
  ParameterDecl density;
  density.id = "material.density";
  const auto fitted = scene::fitToDeclaration(*scene, scene->bodies[0].params[0], {density});
  REQUIRE_FALSE(fitted.has_value());
  CHECK_THAT(fitted.error().message, Contains("test.toml:5: ") &&
                                         Contains("'material.plastic.yield' is not served yet") &&
                                         Contains("material.density"));
}

TEST_CASE("What is to be seen stands in a scene like what is to be solved") {
  const auto scene = parse("format = 1\n[view]\nsurface = \"transparent\"\ncolour = \"von_mises\"\nrange = 2.5\n" +
                           kMinimal.substr(kMinimal.find('\n') + 1));
  REQUIRE(scene.has_value());
  CHECK(findValue(scene->world, "view.surface")->value.text == "transparent");
  CHECK(findValue(scene->world, "view.colour")->value.text == "von_mises");
  CHECK(findValue(scene->world, "view.colour")->line == 4);
  CHECK(findValue(scene->world, "view.range")->value.num == 2.5);
}
