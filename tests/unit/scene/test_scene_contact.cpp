// SPDX-License-Identifier: Apache-2.0
// Contact between bodies, and with external objects.
#include "scene_text.h"

using namespace c3de;

namespace {

const std::string kTwo = kMinimal +
                         "name = \"liver\"\n[[body]]\nname = \"kidney\"\nmesh = \"block.obj\"\nmesh_unit = \"m\"\n"
                         "[[obstacle]]\nname = \"table\"\nmesh = \"block.obj\"\nmesh_unit = \"m\"\n";

std::string paired(const std::string &lines) { return kTwo + "[[contact.pair]]\n" + lines; }
std::string touched(const std::string &lines) { return kMinimal + "[[probe_tool]]\n" + lines; }

const std::string kPath = "path = [ { time = 0, at = [0, 1, 0] }, { time = 0.5, at = [0, 0.5, 0] } ]\n";

}  // namespace

TEST_CASE("Contact is values of the world, and pairs by name", "[scene][contact]") {
  const auto scene = parse(kTwo + R"([contact]
enabled = true
self = false
friction = 0.2
[[contact.pair]]
bodies = ["liver", "kidney"]
friction = 0.05
[[contact.pair]]
bodies = ["table", "liver"]
enabled = false
[[contact.pair]]
bodies = ["kidney", "box"]
friction = 0
enabled = true
)");
  REQUIRE(scene.has_value());
  CHECK(findValue(scene->world, "contact.enabled")->value.num == 1.0);
  CHECK(findValue(scene->world, "contact.self")->value.num == 0.0);
  CHECK(findValue(scene->world, "contact.friction")->value.num == 0.2);
  CHECK(findValue(scene->world, "contact.friction")->line == 17);
  REQUIRE(scene->contactPairs.size() == 3);
  CHECK(scene->contactPairs[0].names == std::array<std::string, 2>{"liver", "kidney"});
  CHECK(scene->contactPairs[0].friction == 0.05);
  CHECK(scene->contactPairs[0].enabled);
  CHECK(scene->contactPairs[0].line == 18);
  CHECK_FALSE(scene->contactPairs[1].friction);
  CHECK_FALSE(scene->contactPairs[1].enabled);
  CHECK(scene->contactPairs[2].names[1] == scene::kWallsName);
  // The pairs may precede the bodies.
  CHECK(parse("format = 1\ncontact = { pair = [ { bodies = [\"liver\", \"table\"], friction = 1 } ] }\n" +
              kTwo.substr(kTwo.find('\n') + 1))
            ->contactPairs.size() == 1);
}

TEST_CASE("Pairs that cannot be are refused by name", "[scene][contact]") {
  const std::string both = "bodies = [\"liver\", \"kidney\"]\n";
  CHECK_THAT(errorOf(paired("bodies = [\"liver\", \"kidny\"]\nfriction = 0.1\n")),
             Contains("test.toml:14: there is no body, obstacle or probe tool 'kidny'") &&
                 Contains("did you mean 'kidney'?") && Contains("accepted: liver, kidney, box, table"));
  CHECK_THAT(errorOf(paired("bodies = [\"liver\", \"liver\"]\nfriction = 0.1\n")), Contains("'liver' twice"));
  CHECK_THAT(errorOf(paired("bodies = [\"table\", \"box\"]\nfriction = 0.1\n")),
             Contains("neither 'table' nor 'box' is a body"));
  CHECK_THAT(errorOf(paired("bodies = [\"liver\"]\nfriction = 0.1\n")),
             Contains("bodies is [\"liver\"]; accepted: two names"));
  CHECK_THAT(errorOf(paired("friction = 0.1\n")), Contains("no 'bodies'"));
  CHECK_THAT(errorOf(paired(both)), Contains("the pair has no settings"));
  CHECK_THAT(errorOf(paired(both + "friction = -0.1\n")),
             Contains(":16: friction is -0.1; accepted: a number from 0 to 10"));
  CHECK_THAT(errorOf(paired(both + "friction = nan\n")), Contains("friction is nan"));
  CHECK_THAT(errorOf(paired(both + "enabled = 1\n")), Contains("enabled is a whole number; accepted: true, false"));
  CHECK_THAT(errorOf(paired(both + "fricton = 1\n")),
             Contains("unknown key 'fricton' in [[contact.pair]]") && Contains("did you mean 'friction'"));
  CHECK_THAT(errorOf(paired(both + "friction = 1\n[[contact.pair]]\nbodies = [\"kidney\", \"liver\"]\nfriction = 0\n")),
             Contains("a second pair is of 'kidney' and 'liver'"));
  CHECK_THAT(errorOf(kTwo + "[[obstacle]]\nname = \"liver\"\nmesh = \"block.obj\"\nmesh_unit = \"m\"\n" +
                     "[[contact.pair]]\n" + both + "friction = 1\n"),
             Contains("'liver' is the name of 2"));
  CHECK_THAT(errorOf(kTwo + "[contact]\npair = 3\n"), Contains("'contact.pair' is a whole number"));
  CHECK_THAT(errorOf("format = 1\ncontact = 1\n" + kTwo.substr(kTwo.find('\n') + 1)),
             Contains("'contact' is a whole number"));
}

TEST_CASE("A probe tool is a sphere, or a capsule, on a path", "[scene][contact]") {
  const auto scene = parse(touched("name = \"finger\"\nradius_mm = 6\nfriction = 0.1\n" + kPath) +
                           "[[probe_tool]]\nradius_mm = 2\nlength_mm = 30\npath = [ { time = 0, at = [0, 1, 0], axis = "
                           "[1, 0, 0] }, { time = 1, at = [0, 1, 0] } ]\n");
  REQUIRE(scene.has_value());
  REQUIRE(scene->probeTools.size() == 2);
  const scene::SceneProbeTool &finger = scene->probeTools[0];
  CHECK(finger.name == "finger");
  CHECK(finger.radius_m == 0.006);
  CHECK(finger.length_m == 0.0);
  CHECK(finger.friction == 0.1);
  REQUIRE(finger.path.size() == 2);
  CHECK(finger.path[1].time_s == 0.5);
  CHECK(finger.path[1].at_m == Vec3{0, 0.5, 0});
  CHECK_FALSE(finger.path[0].axis);
  CHECK(scene->probeTools[1].name == "tool-2");
  CHECK(scene->probeTools[1].friction == 0.3);
  CHECK(scene->probeTools[1].length_m == 0.03);
  CHECK(scene->probeTools[1].path[0].axis == Vec3{1, 0, 0});
  CHECK_FALSE(scene->probeTools[1].path[1].axis);
}

TEST_CASE("A probe tool that says too little or what cannot be is refused", "[scene][contact]") {
  const std::string radius = "radius_mm = 6\n";
  const auto path = [&](const std::string &places) { return errorOf(touched(radius + "path = [ " + places + " ]\n")); };
  CHECK_THAT(errorOf(touched(kPath)), Contains("test.toml:5: the probe tool has no 'radius_mm'"));
  CHECK_THAT(errorOf(touched(radius)), Contains("no 'path'") && Contains("at least two places"));
  CHECK_THAT(errorOf(touched("radius_mm = 0\n" + kPath)),
             Contains(":6: radius_mm is 0; accepted: a number above 0, mm"));
  CHECK_THAT(errorOf(touched("radius_mm = -3\n" + kPath)), Contains("radius_mm is -3"));
  CHECK_THAT(errorOf(touched("radius_mm = inf\n" + kPath)), Contains("radius_mm is inf"));
  CHECK_THAT(errorOf(touched(radius + "length_mm = -1\n" + kPath)), Contains("length_mm is -1"));
  CHECK_THAT(errorOf(touched("radius = 6\n" + kPath)),
             Contains("unknown key 'radius' in [[probe_tool]]; accepted: name, radius_mm"));
  CHECK_THAT(path("{ time = 0, at = [0, 1, 0] }"), Contains("path has 1 place"));
  CHECK_THAT(path("1, 2"), Contains("path is [1, 2]"));
  CHECK_THAT(path("{ time = 0, at = [0, 1, 0] }, { time = 0, at = [0, 0, 0] }"),
             Contains("time 0 follows 0") && Contains("times that ascend"));
  CHECK_THAT(path("{ time = 1, at = [0, 1, 0] }, { time = 0.5, at = [0, 0, 0] }"), Contains("time 0.5 follows 1"));
  CHECK_THAT(path("{ time = -1, at = [0, 1, 0] }, { time = 0.5, at = [0, 0, 0] }"), Contains("time is -1"));
  CHECK_THAT(path("{ time = 0 }, { time = 0.5, at = [0, 0, 0] }"), Contains("a place of the path has no 'at'"));
  CHECK_THAT(path("{ time = 0, at = [0, 1] }, { time = 0.5, at = [0, 0, 0] }"), Contains("at is [0, 1]"));
  CHECK_THAT(path("{ time = 0, att = [0, 1] }, { time = 0.5, at = [0, 0, 0] }"), Contains("did you mean 'at'"));
  CHECK_THAT(path("{ time = 0, at = [0, 1, 0], axis = [1, 0, 0] }, { time = 0.5, at = [0, 0, 0] }"),
             Contains("'axis' and no 'length_mm'"));
  CHECK_THAT(errorOf(touched(radius + "length_mm = 4\npath = [ { time = 0, at = [0, 1, 0], axis = [0, 0, 0] }, "
                                      "{ time = 1, at = [0, 1, 0] } ]\n")),
             Contains("axis is [0, 0, 0]"));
  CHECK_THAT(errorOf(touched("name = \"a\"\n" + radius + kPath) + "[[probe_tool]]\nname = \"a\"\n" + radius + kPath),
             Contains("a second probe tool is named 'a'"));
}

TEST_CASE("Contact and probe tools are set from the command line", "[scene][contact]") {
  auto scene = parse(paired("bodies = [\"liver\", \"kidney\"]\nfriction = 0.1\n") +
                     "[[probe_tool]]\nname = \"finger\"\nradius_mm = 6\n" + kPath);
  REQUIRE(scene.has_value());
  const auto set = [&](const std::string &assignment) { return scene::applyOverride(*scene, assignment, &presets()); };
  const auto refusal = [&](const std::string &assignment) {
    const auto done = set(assignment);
    return done ? std::string() : done.error().message;
  };
  REQUIRE(set("contact.friction=0.1"));
  CHECK(findValue(scene->world, "contact.friction")->value.num == 0.1);
  REQUIRE(set("contact.enabled=false"));
  REQUIRE(set("contact.pair.0.friction=0.4"));
  REQUIRE(set("contact.pair.0.enabled=false"));
  CHECK(scene->contactPairs[0].friction == 0.4);
  CHECK_FALSE(scene->contactPairs[0].enabled);
  REQUIRE(set("probe_tool.finger.radius_mm=4"));
  CHECK(scene->probeTools[0].radius_m == 0.004);
  REQUIRE(set("probe_tool.0.path=[{time=0,at=[0,0,0]},{time=2,at=[0,0,1]}]"));
  CHECK(scene->probeTools[0].path[1].time_s == 2.0);
  CHECK_THAT(refusal("contact.pair.1.friction=0.4"), Contains("no such pair; the scene has 1"));
  CHECK_THAT(refusal("contact.pair.0.bodies=[\"liver\",\"lung\"]"), Contains("'lung'"));
  CHECK_THAT(refusal("probe_tool.finger.name=a"), Contains("cannot be changed"));
  CHECK_THAT(refusal("probe_tool.fingr.radius_mm=4"), Contains("did you mean 'finger'"));
  CHECK_THAT(refusal("probe_tool.finger.radius_mm=0"), Contains("radius_mm is 0"));
  CHECK_THAT(refusal("contct.friction=0.4"), Contains("did you mean 'contact.friction'"));
}
