// SPDX-License-Identifier: Apache-2.0
// Bodies of many tissues as specified by scenes; the consequences of the map are tested where it is read.
#include "scene_text.h"

using namespace c3de;
using Catch::Matchers::Contains;

namespace {

std::string bodyWith(const std::string &tissues, const std::string &more = "") {
  return "format = 1\n[[body]]\nname = \"scan\"\nvolume = \"beam.obj\"\ntissues = " + tissues + "\n" + more;
}

}  // namespace

TEST_CASE("Tissues that say their materials have parts at once", "[tissues]") {
  const auto scene =
      parse(bodyWith("[ { label = \"liver\", material = \"spleen\" }, { label = \"a*\", rigid = true } ]"));
  REQUIRE(scene);
  const scene::SceneBody &body = scene->bodies.front();
  CHECK_FALSE(body.volume.isOpen());
  REQUIRE(body.parts.size() == 1);
  CHECK(body.volume.tissues[0].preset == "spleen");
  CHECK(findValue(body.parts[0].params, "material.youngs_modulus")->value.num == 3000.0);
  // Without a background the body has the material of the first tissue.
  CHECK(findValue(body.params, "material.youngs_modulus")->value.num == 3000.0);
}

TEST_CASE("Tissues that only say a name wait for the map, and so do overrides of their parts", "[tissues]") {
  for (const char *tissues :
       {"\"known\"", "[ { label = \"Left Kidney\" }, { label = \"rib*\" } ]", "[ { label = 3 } ]"}) {
    CAPTURE(tissues);
    auto scene = parse(bodyWith(tissues));
    REQUIRE(scene);
    CHECK(scene->bodies.front().volume.isOpen());
    CHECK(scene->bodies.front().parts.empty());
    const std::string assignment = "body.scan.parts.7.material.youngs_modulus = 9e3";
    REQUIRE(scene::applyOverride(*scene, assignment, &presets()));
    CHECK(scene->bodies.front().volume.overridesOfParts == std::vector<std::string>{assignment});
    const auto whole = scene::applyOverride(*scene, "body.scan.tissues=known", &presets());
    REQUIRE_FALSE(whole);
    CHECK_THAT(whole.error().message, Contains("cannot be changed here"));
  }
}

TEST_CASE("A tissue by a name that is not known is refused where it stands", "[tissues]") {
  CHECK_THAT(errorOf(bodyWith("[ { label = \"livr\" } ]")),
             Contains("test.toml:5: no tissue is known by the name 'livr'; did you mean 'liver'?"));
  CHECK_THAT(errorOf(bodyWith("[ { label = \"livr\", rigid = false } ]")), Contains("did you mean 'liver'?"));
  CHECK_THAT(errorOf(bodyWith("\"konwn\"")), Contains("tissues is \"konwn\"; accepted: \"known\", or a list"));
  CHECK_THAT(errorOf(bodyWith("3")), Contains("tissues is") && Contains("accepted: \"known\", or ["));
  CHECK_THAT(errorOf(bodyWith("[]")), Contains("tissues is empty"));
  CHECK_THAT(errorOf(bodyWith("\"known\"", "label = 3\n")), Contains("'tissues' and 'label'"));
  CHECK_THAT(errorOf(bodyWith("\"known\"", "material = \"liver\"\n")), Contains("'tissues' and 'material'"));
  CHECK_THAT(errorOf(bodyWith("[ { label = \"liver\", rigid = true, material = \"fat\" } ]")),
             Contains("has a material and is rigid"));
}

TEST_CASE("A tissue may be left out of the 3D view, and have a colour there", "[tissues]") {
  const auto scene =
      parse(bodyWith("[ { label = \"liver\", show = false }, { label = \"a*\", material = \"fat\", "
                     "colour = [0.5, 0, 1] } ]"));
  REQUIRE(scene);
  const auto &tissues = scene->bodies.front().volume.tissues;
  CHECK_FALSE(tissues[0].isShown);
  CHECK_FALSE(tissues[0].colour);
  CHECK(tissues[1].isShown);
  CHECK(tissues[1].colour == Vec3{0.5, 0.0, 1.0});
  CHECK_THAT(errorOf(bodyWith("[ { label = \"liver\", colour = [0.5, 0, 255] } ]")),
             Contains("tissues: colour is (0.5, 0, 255); accepted: red, green and blue from 0 to 1"));
  CHECK_THAT(errorOf(bodyWith("[ { label = \"liver\", show = 3 } ]")), Contains("tissues: show"));
}

TEST_CASE("Parts of tissues leave what an override has said of the body", "[tissues]") {
  auto scene = parse(bodyWith("\"known\""));
  REQUIRE(scene);
  REQUIRE(scene::applyOverride(*scene, "body.scan.material.youngs_modulus=77", &presets()));
  scene::SceneBody &body = scene->bodies.front();
  for (const char *label : {"trachea", "vertebrae_L1", "liver", "csf"}) {
    body.volume.tissues.emplace_back();
    body.volume.tissues.back().label = label;
    REQUIRE(scene::setMaterialFromName(body.volume.tissues.back(), label, presets()));
  }
  REQUIRE(scene::makeTissueParts(body));
  REQUIRE(body.parts.size() == 2);
  CHECK(body.parts[0].name == "liver");
  CHECK(findValue(body.parts[0].params, "material.youngs_modulus")->value.num == 6000.0);
  CHECK(findValue(body.parts[1].params, "material.youngs_modulus")->value.num == 1400.0);
  CHECK(findValue(body.params, "material.youngs_modulus")->value.num == 77.0);
  CHECK(findValue(body.params, "material.density")->value.num == 1060.0);
  body.volume.tissues.resize(2);  // air and bone
  body.parts.clear();
  const auto none = scene::makeTissueParts(body);
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().message, Contains("all tissues are rigid or empty"));
}

TEST_CASE("What slides is read as names, numbers and lists, and its pieces have names of their own", "[tissues]") {
  const auto scene =
      parse(bodyWith("\"known\"", "slides = [\"liver\", \"lung_*\", 5, [\"spleen\", \"colon\"], \"*lung\"]\n") +
            "[[probe]]\nname = \"tip\"\nbody = \"scan.lung\"\nat = [0, 0, 0]\n"
            "[[attachment]]\nbodies = [\"scan.5\", \"surroundings\"]\nstiffness = 1e4\n"
            "[[contact.pair]]\nbodies = [\"scan\", \"scan.liver\"]\nfriction = 0.1\n");
  REQUIRE(scene);
  const scene::SceneVolume &volume = scene->bodies.front().volume;
  REQUIRE(volume.slides.size() == 5);
  CHECK(volume.slides[2].names == std::vector<std::string>{"5"});
  CHECK(volume.slides[3].names == std::vector<std::string>{"spleen", "colon"});
  CHECK(volume.slidingFriction == scene::kSlideFriction);
  CHECK(scene::namesOfBodies(*scene) ==
        std::vector<std::string>{"scan", "scan.liver", "scan.lung", "scan.5", "scan.spleen", "scan.lung-2"});
  // Of the piece, not of the body.
  CHECK(findValue(volume.slides[2].params, "surroundings.stiffness")->value.num == 1e4);
  CHECK(findValue(scene->bodies.front().params, "surroundings.stiffness") == nullptr);
}

TEST_CASE("What is not right about what slides is refused where it stands", "[tissues]") {
  const auto refusal = [](const std::string &slides) { return errorOf(bodyWith("\"known\"", slides + "\n")); };
  CHECK_THAT(refusal("slides = \"liver\""),
             Contains("test.toml:6: slides is the text \"liver\"; accepted: a list, [\"liver\""));
  CHECK_THAT(refusal("slides = []"), Contains("slides is an empty list; accepted: a list"));
  CHECK_THAT(refusal("slides = [\"liver\", -3]"), Contains("a label is -3; accepted: the name of a label"));
  CHECK_THAT(refusal("slides = [\"\"]"), Contains("a label is") && Contains("accepted: the name of a label"));
  CHECK_THAT(refusal("slides = [\"liver\", []]"), Contains("an entry of slides is an empty list"));
  CHECK_THAT(refusal("slides = [\"liver\", [\"spleen\", \"liver\"]]"), Contains("slides names 'liver' twice"));
  CHECK_THAT(refusal("slides = [\"liver\"]\nslide_friction = 11"),
             Contains("test.toml:7: slide_friction is 11; accepted: a number from 0 to 10"));
  CHECK_THAT(refusal("slide_friction = 0.1"), Contains("'slide_friction' belongs to a body with 'slides'"));
  const std::string label = "format = 1\n[[body]]\nname = \"scan\"\nvolume = \"beam.obj\"\nlabel = 5\n";
  CHECK_THAT(errorOf(label + "slides = [\"liver\"]\n"),
             Contains("test.toml:6: 'slides' belongs to a body with 'tissues'; accepted: tissues = \"known\""));
  CHECK_THAT(errorOf("format = 1\n[[body]]\nmesh = \"beam.obj\"\nmesh_unit = \"mm\"\nslides = [\"liver\"]\n"),
             Contains("'slides' belongs to a body with a 'volume'"));
  CHECK_THAT(refusal("slides = [\"liver\"]\n[[body]]\nname = \"scan.liver\"\nmesh = \"beam.obj\"\nmesh_unit = \"mm\""),
             Contains("'scan.liver' is the name of a body and of a piece of 'scan'"));
  CHECK_THAT(refusal("slides = [\"liver\"]\n[[body]]\nname = \"scan.rest\"\nmesh = \"beam.obj\"\nmesh_unit = \"mm\""),
             Contains("'scan.rest' is the name of a body and of a piece of 'scan'"));
  CHECK_THAT(refusal("slides = [\"liver\"]\n[[fix]]\nbody = \"scan.livr\"\nregion = { everywhere = true }"),
             Contains("there is no body 'scan.livr'; did you mean 'scan.liver'?"));
}

TEST_CASE("What slides can be set for a body with tissues, and names of pieces follow", "[tissues]") {
  auto scene = parse(bodyWith("\"known\"",
                              "slides = [\"liver\"]\n[[fix]]\nbody = \"scan.liver\"\n"
                              "region = { everywhere = true }\n"));
  REQUIRE(scene);
  REQUIRE(scene::applyOverride(*scene, "body.scan.slides=[\"spleen\", \"liver\"]", &presets()));
  CHECK(scene->bodies.front().volume.slides.size() == 2);
  REQUIRE(scene::applyOverride(*scene, "body.scan.slide_friction=0.5", &presets()));
  CHECK(scene->bodies.front().volume.slidingFriction == 0.5);
  const auto gone = scene::applyOverride(*scene, "body.scan.slides=[\"spleen\"]", &presets());
  REQUIRE_FALSE(gone);
  CHECK_THAT(gone.error().message, Contains("there is no body 'scan.liver'"));
}

TEST_CASE("A piece is set by its name, and what is said of it counts more than what is said of its body", "[tissues]") {
  auto scene = parse(bodyWith("[ { label = 1, material = \"liver\" }, { label = \"tumour\", material = \"spleen\" } ]",
                              "slides = [\"liver\", \"liver.left\", \"lung*\"]\nsampling = { spacing = 0.01 }\n"
                              "[[attachment]]\nbodies = [\"scan\", \"surroundings\"]\nstiffness = 1e4\n"));
  REQUIRE(scene);
  const auto set = [&](const std::string &assignment) {
    CAPTURE(assignment);
    REQUIRE(scene::applyOverride(*scene, assignment, &presets()));
  };
  set("body.scan.liver.material.youngs_modulus=7e3");
  set("body.scan.liver.sampling.count=50");
  set("body.scan.liver.left.material=spleen");  // the longest name
  set("body.0.lung.surroundings.stiffness=5");
  set("body.scan.sampling.count=900");
  set("body.scan.material.youngs_modulus=8e3");
  const scene::SceneBody &body = scene->bodies.front();
  CHECK(findValue(body.params, "material.youngs_modulus")->value.num == 8e3);
  const scene::SceneBody liver = scene::bodyOfPiece(body, 0), left = scene::bodyOfPiece(body, 1),
                         lung = scene::bodyOfPiece(body, 2);
  CHECK(liver.name == "scan.liver");
  CHECK(liver.volume.piece == 1);
  // All of its tissues.
  CHECK(findValue(liver.params, "material.youngs_modulus")->value.num == 7e3);
  for (const scene::ScenePart &part : liver.parts)
    CHECK(findValue(part.params, "material.youngs_modulus")->value.num == 7e3);
  CHECK(findValue(liver.parts[0].params, "material.density") != nullptr);
  CHECK(findValue(left.parts[0].params, "material.youngs_modulus")->value.num == 3000.0);
  CHECK(findValue(lung.params, "material.youngs_modulus")->value.num == 8e3);
  CHECK(findValue(lung.params, "surroundings.stiffness")->value.num == 5.0);
  CHECK(findValue(liver.params, "surroundings.stiffness") == nullptr);
  // Of three settings for the number of points, that of the piece counts.
  ParameterDecl spacing, count;
  spacing.id = "sampling.spacing";
  count.id = "sampling.count";
  count.type = C3DE_PARAM_I64;
  count.alternativeTo = spacing.id;
  for (ParameterDecl *decl : {&spacing, &count}) decl->max = 1e6;
  const auto sampled = [&](const scene::SceneBody &of) {
    std::vector<scene::SceneValue> values = of.params;
    std::erase_if(values, [](const auto &value) { return value.value.id.rfind("sampling.", 0) != 0; });
    auto fitted = scene::fitToDeclarations(*scene, values, {spacing, count});
    if (!fitted) FAIL(fitted.error().message);
    REQUIRE(fitted->size() == 1);
    return fitted->front();
  };
  CHECK(sampled(liver).id == "sampling.count");
  CHECK(sampled(liver).num == 50.0);
  CHECK(sampled(lung).num == 900.0);
  set("body.scan.lung.sampling.spacing=0.002");
  const ParameterValue fine = sampled(scene::bodyOfPiece(scene->bodies.front(), 2));
  CHECK(fine.id == "sampling.spacing");
  CHECK(fine.num == 0.002);
}

TEST_CASE("The rest of what slides has a name of its own, and what is said of it is of it alone", "[tissues]") {
  auto scene = parse(bodyWith("[ { label = 1, material = \"liver\" } ]",
                              "slides = [\"liver\", \"rest\"]\nvelocity = [1, 0, 0]\n"
                              "[[fix]]\nbody = \"scan.rest-2\"\nregion = { everywhere = true }\n"
                              "[[attachment]]\nbodies = [\"scan.rest-2\", \"surroundings\"]\nstiffness = 1e4\n"
                              "[[contact.pair]]\nbodies = [\"scan.rest-2\", \"scan.liver\"]\nfriction = 0.1\n"));
  REQUIRE(scene);
  // A label with the name rest keeps its name.
  CHECK(scene::referableNames(*scene) == std::vector<std::string>{"scan", "scan.liver", "scan.rest", "scan.rest-2"});
  for (const char *assignment :
       {"body.scan.rest-2.material.density=800", "body.scan.rest-2.rigid=true", "body.scan.rest-2.free=true",
        "body.scan.liver.velocity=[0,0,2]", "body.scan.rest.material.density=700"}) {
    CAPTURE(assignment);
    REQUIRE(scene::applyOverride(*scene, assignment, &presets()));
  }
  const scene::SceneBody &body = scene->bodies.front();
  const scene::SceneBody rest = scene::bodyOfRest(body), liver = scene::bodyOfPiece(body, 0),
                         label = scene::bodyOfPiece(body, 1);
  CHECK(rest.name == "scan");
  CHECK(rest.volume.piece == 0);
  CHECK(rest.volume.slides.empty());
  CHECK(findValue(rest.parts[0].params, "material.density")->value.num == 800.0);
  CHECK(findValue(label.parts[0].params, "material.density")->value.num == 700.0);
  CHECK(findValue(rest.params, "surroundings.stiffness")->value.num == 1e4);
  CHECK(scene::trueOf(rest.params, "rigid"));
  CHECK(scene::trueOf(rest.params, "free"));
  CHECK_FALSE(scene::trueOf(liver.params, "rigid"));
  CHECK(rest.velocity_m_s == Vec3{1, 0, 0});
  CHECK(liver.velocity_m_s == Vec3{0, 0, 2});
  // Without slides there is no rest.
  auto whole = parse(bodyWith("\"known\"", ""));
  REQUIRE(whole);
  CHECK(scene::referableNames(*whole) == std::vector<std::string>{"scan"});
  CHECK_FALSE(scene::applyOverride(*whole, "body.scan.rest.rigid=true", &presets()));
}

TEST_CASE("What a piece cannot have of its own, and names of no piece, are refused with what is accepted",
          "[tissues]") {
  auto scene = parse(bodyWith("\"known\"", "slides = [\"liver\", \"lung*\"]\n"));
  REQUIRE(scene);
  const auto refusal = [&](const std::string &assignment) {
    CAPTURE(assignment);
    const auto refused = scene::applyOverride(*scene, assignment, &presets());
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::usage);
    return refused.error().message;
  };
  for (const char *key : {"position=[0,0,0]", "scale=2", "angular_velocity=[0,0,1]", "sampling.refine=[]", "label=3",
                          "parts.0.material.density=900", "slides=[\"liver\"]"})
    CHECK_THAT(refusal("body.scan.liver." + std::string(key)),
               Contains("applies to the whole of 'scan' and cannot be set for a piece; accepted: material, material.…, "
                        "sampling.… except refine, surroundings.…, velocity, rigid, free"));
  CHECK_THAT(refusal("body.scan.liver=3"), Contains("has no key for a piece of 'scan'; accepted: material, "));
  CHECK_THAT(refusal("body.scan.liver.material=livr"), Contains("did you mean 'liver'?"));
  CHECK_THAT(
      refusal("body.scan.livr.material.density=900"),
      Contains("--set body.scan.livr.material.density: there is no piece 'scan.livr'; did you mean 'scan.liver'? "
               "accepted: scan.liver, scan.lung, scan.rest; keys of 'scan': material.…"));
  CHECK_THAT(
      refusal("body.scam.material.density=900"),
      Contains("there is no body 'scam'; did you mean 'scan'? accepted: scan, scan.liver, scan.lung, scan.rest"));
  CHECK_THAT(refusal("boddy.scan.liver.material.density=900"),
             Contains("did you mean 'body.scan.liver.material.density'?") && Contains("body.scan.lung.…"));
}

TEST_CASE("What has been said of a piece stays with its name when others slide", "[tissues]") {
  auto scene = parse(bodyWith("\"known\"",
                              "slides = [\"liver\", \"lung*\"]\n"
                              "[[attachment]]\nbodies = [\"scan.lung\", \"surroundings\"]\nstiffness = 1e4\n"));
  REQUIRE(scene);
  REQUIRE(scene::applyOverride(*scene, "body.scan.lung.material.density=300", &presets()));
  REQUIRE(scene::applyOverride(*scene, "body.scan.slides=[\"lung*\", \"spleen\"]", &presets()));
  const std::vector<scene::SceneSlidingPart> &slides = scene->bodies.front().volume.slides;
  REQUIRE(slides.size() == 2);
  CHECK(findValue(slides[0].params, "material.density")->value.num == 300.0);
  CHECK(findValue(slides[0].params, "surroundings.stiffness")->value.num == 1e4);
  CHECK(slides[1].params.empty());
  const auto gone = scene::applyOverride(*scene, "body.scan.slides=[\"spleen\"]", &presets());
  REQUIRE_FALSE(gone);
  CHECK_THAT(gone.error().message, Contains("there is no piece 'scan.lung'") && Contains("accepted: scan.spleen"));
}

TEST_CASE("A tissue of several labels lists them", "[tissues]") {
  const auto scene = parse(bodyWith(
      "[ { label = [\"kidney_left\", \"kidney_right\"] }, { label = [7, \"a*\", \"b\", \"c\"], rigid = true } ]"));
  REQUIRE(scene);
  const std::vector<scene::SceneTissue> &tissues = scene->bodies.front().volume.tissues;
  CHECK(tissues[0].isMaterialByName);
  CHECK(tissues[0].wanted == std::vector<std::string>{"kidney_left", "kidney_right"});
  CHECK(tissues[1].wanted == std::vector<std::string>{"7", "a*", "b", "c"});
  CHECK(tissues[1].label == "7, a*, b and 1 more");
  CHECK_THAT(errorOf(bodyWith("[ { label = [] } ]")), Contains("label is an empty list"));
  CHECK_THAT(errorOf(bodyWith("[ { label = [\"liver\", 0.5] } ]")), Contains("label is 0.5; accepted: the name"));
  CHECK_THAT(errorOf(bodyWith("[ { label = [\"liver\", \"gizmo\"] } ]")), Contains("by the name 'gizmo'"));
}

TEST_CASE("A background says its series and time, a body of a volume its region", "[tissues]") {
  const auto scene = parse(
      bodyWith("\"known\"",
               "background = { material = \"fat\", image = \"beam.obj\", from = 0, to = 1, series = 3, time = 2 }\n"
               "region = { box = { min = [0, 0, 0], max = [0.1, 0.2, 0.3] } }\n"));
  REQUIRE(scene);
  const scene::SceneVolume &volume = scene->bodies.front().volume;
  CHECK(volume.background->series == "3");
  CHECK(volume.background->time == 2);
  REQUIRE(volume.region);
  CHECK(volume.region->b == Vec3{0.1, 0.2, 0.3});
  CHECK_THAT(errorOf(bodyWith("\"known\"", "background = { material = \"fat\", image = \"beam.obj\", from = 0 }\n")),
             Contains("background has no 'to'"));
  CHECK_THAT(errorOf("format = 1\n[[body]]\nmesh = \"beam.obj\"\nregion = { everywhere = true }\n"),
             Contains("'region' belongs to a body with a 'volume'"));
}
