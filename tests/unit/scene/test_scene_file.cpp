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
  // The range of tissue stiffness is also known; a simulator without such a display does not use it.
  const auto *low = findValue(changed->bodies[0].params, "material.youngs_modulus_low");
  const auto *high = findValue(changed->bodies[0].params, "material.youngs_modulus_high");
  REQUIRE((low && high));
  CHECK(low->value.num == 1000.0);
  CHECK(high->value.num == 15000.0);
  CHECK((low->isOptional && high->isOptional));
  CHECK(changed->bodies[0].params.size() == 5);
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
    return scene::fitToDeclarations(*scene, {*findValue(scene->bodies[0].params, id)}, decls);
  };

  CHECK(fit("material.density").value().front().type == C3DE_PARAM_F64);
  CHECK(fit("material.law").value().front().type == C3DE_PARAM_CHOICE);
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

TEST_CASE("A key that the simulator does not declare is refused with its line and the nearest") {
  const auto scene = parse(kMinimal + "material = { plastic = { yield = 0.1 } }\n");
  REQUIRE(scene.has_value());
  ParameterDecl density;
  density.id = "material.density";
  const auto fitted = scene::fitToDeclarations(*scene, scene->bodies[0].params, {density});
  REQUIRE_FALSE(fitted.has_value());
  CHECK_THAT(fitted.error().message, Contains("test.toml:5: ") && Contains("unknown key 'material.plastic.yield'") &&
                                         Contains("material.density"));
}

TEST_CASE("Of two ways to say the same thing a scene says one, and an override counts") {
  ParameterDecl spacing, count;
  spacing.id = "sampling.spacing";
  count.id = "sampling.count";
  spacing.max = count.max = 1e6;
  count.alternativeTo = spacing.id;
  const std::vector<ParameterDecl> decls{spacing, count};
  auto scene = parse(kMinimal + "sampling = { spacing = 0.1, count = 3 }\n");
  REQUIRE(scene.has_value());
  const auto both = scene::fitToDeclarations(*scene, scene->bodies[0].params, decls);
  REQUIRE_FALSE(both.has_value());
  CHECK_THAT(both.error().message, Contains("test.toml:5: ") && Contains("'sampling.count'") &&
                                       Contains("'sampling.spacing'") && Contains("one of them"));
  for (const bool isCount : {true, false}) {
    scene = parse(kMinimal + (isCount ? "sampling = { spacing = 0.1 }\n" : "sampling = { count = 3 }\n"));
    REQUIRE(scene.has_value());
    const std::string name = scene->bodies[0].name;
    REQUIRE(scene::applyOverride(*scene, "body." + name + (isCount ? ".sampling.count=7" : ".sampling.spacing=7"),
                                 nullptr));
    const auto fitted = scene::fitToDeclarations(*scene, scene->bodies[0].params, decls);
    REQUIRE(fitted.has_value());
    REQUIRE(fitted->size() == 1);
    CHECK(fitted->front().id == (isCount ? count.id : spacing.id));
    CHECK(fitted->front().num == 7.0);
  }
}

TEST_CASE("What is declared to be said together is not said in part, and an entry too many is unknown") {
  std::vector<ParameterDecl> decls(4);
  const char *const ids[] = {"material.prony1.share", "material.prony1.time", "material.prony2.share",
                             "material.prony2.time"};
  for (std::size_t i = 0; i < 4; ++i) {
    decls[i].id = ids[i];
    decls[i].max = 10.0;
    decls[i].flags = C3DE_PARAM_TOGETHER;
  }
  const auto fit = [&](const std::string &terms) {
    const auto scene = parse(kMinimal + "material = { prony = [ " + terms + " ] }\n");
    REQUIRE(scene.has_value());
    return scene::fitToDeclarations(*scene, scene->bodies[0].params, decls);
  };
  CHECK(fit("{ share = 0.1, time = 2 }").value().size() == 2);
  const auto part = fit("{ share = 0.1, time = 2 }, { share = 0.1 }");
  REQUIRE_FALSE(part.has_value());
  CHECK_THAT(part.error().message,
             Contains("test.toml:5: ") && Contains("'material.prony2.share' without 'material.prony2.time'"));
  const auto third = fit("{ share = 0.1, time = 2 }, { share = 0.1, time = 3 }, { share = 0.1, time = 4 }");
  REQUIRE_FALSE(third.has_value());
  CHECK_THAT(third.error().message, Contains("unknown key 'material.prony3.share'") && Contains("material.prony"));
}

TEST_CASE("A scene names the class that simulates") {
  auto scene =
      parse("format = 1\n[simulator]\nclass = \"org.example.Sim/1\"\n" + kMinimal.substr(kMinimal.find('\n') + 1));
  REQUIRE(scene.has_value());
  CHECK(scene->simulatorClass == "org.example.Sim/1");
  CHECK(scene->simulatorLine == 3);
  REQUIRE(scene::applyOverride(*scene, "simulator.class=org.example.Other/1", nullptr));
  CHECK(scene->simulatorClass == "org.example.Other/1");
  CHECK(scene->simulatorLine == 0);
  for (const char *bad : {"[simulator]\nclass = \"\"\n", "[simulator]\nclass = 3\n", "[simulator]\nclas = \"x\"\n"}) {
    const auto refused = parse(std::string("format = 1\n") + bad + kMinimal.substr(kMinimal.find('\n') + 1));
    REQUIRE_FALSE(refused.has_value());
    CHECK_THAT(refused.error().message, Contains("test.toml:3: "));
  }
}

TEST_CASE("A matrix places a mesh and a quaternion turns a support, and what is neither is refused") {
  const auto scene = parse(kMinimal +
                           "matrix = [[0,-1,0,1],[1,0,0,2],[0,0,1,3],[0,0,0,1]]\n[[fix]]\nregion = { everywhere = "
                           "true }\nquaternion = [0, 0, 0.6, 0.8]\n");
  REQUIRE(scene.has_value());
  const auto &matrix = scene->bodies[0].placement.matrix;
  REQUIRE(matrix.has_value());
  CHECK((*matrix)[1] == 1.0);
  CHECK((*matrix)[4] == -1.0);
  CHECK((*matrix)[13] == 2.0);
  REQUIRE(scene->fixes[0].motion.quaternion.has_value());
  CHECK((*scene->fixes[0].motion.quaternion)[3] == 0.8);
  struct Bad {
    const char *text, *contains;
  };
  for (const Bad &bad :
       {Bad{"matrix = [[1,0,0,1],[1,0,0,2],[0,0,1,3]]\n", "four rows"},
        Bad{"matrix = [[1,0,0,nan],[0,1,0,2],[0,0,1,3],[0,0,0,1]]\n", "finite"},
        Bad{"matrix = [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]\nscale = 2\n", "'matrix' and 'scale'"},
        Bad{"[[fix]]\nregion = { everywhere = true }\nquaternion = [0, 0, 1, 1]\n", "length 1"},
        Bad{"[[fix]]\nregion = { everywhere = true }\nquaternion = [0, 0, 1]\n", "[x, y, z, w]"},
        Bad{"[[fix]]\nregion = { everywhere = true }\nquaternion = [0, 0, 0, 1]\nrotation_deg = [1, 0, "
            "0]\n",
            "one of them"}}) {
    const auto refused = parse(kMinimal + bad.text);
    INFO(bad.text);
    REQUIRE_FALSE(refused.has_value());
    CHECK_THAT(refused.error().message, Contains("test.toml:") && Contains(bad.contains));
  }
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
