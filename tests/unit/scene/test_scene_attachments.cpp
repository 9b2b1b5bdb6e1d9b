// SPDX-License-Identifier: Apache-2.0
// What holds bodies where they are in the scan, what is rigid, and what of an image stays.
#include "scene_text.h"

using namespace c3de;

namespace {

const std::string kTwo =
    kMinimal + "name = \"liver\"\n[[body]]\nname = \"spine\"\nmesh = \"block.obj\"\nmesh_unit = \"m\"\n";

std::string attached(const std::string &lines) { return kTwo + "[[attachment]]\n" + lines; }
std::string imaged(const std::string &lines) { return kMinimal + "[image]\nfile = \"beam.obj\"\n" + lines; }

}  // namespace

TEST_CASE("An attachment to the surroundings is parameters of its body", "[scene][attachment]") {
  // Before the body that it holds, too.
  const auto scene = parse(
      "format = 1\nattachment = [ { bodies = [\"liver\", \"surroundings\"], stiffness = 1e5, tangential = "
      "2e4, retardation_time = 0.02, tears_at = 0 } ]\n" +
      kTwo.substr(kTwo.find('\n') + 1));
  REQUIRE(scene.has_value());
  const auto &params = scene->bodies[0].params;
  CHECK(findValue(params, "surroundings.stiffness")->value.num == 1e5);
  CHECK(findValue(params, "surroundings.tangential")->value.num == 2e4);
  CHECK(findValue(params, "surroundings.retardation_time")->value.num == 0.02);
  CHECK(findValue(params, "surroundings.stiffness")->line == 2);
  CHECK(findValue(scene->bodies[1].params, "surroundings.stiffness") == nullptr);
}

TEST_CASE("An attachment that is not served yet or says too little is refused by name", "[scene][attachment]") {
  const std::string surroundings = "bodies = [\"liver\", \"surroundings\"]\n";
  CHECK_THAT(errorOf(attached("bodies = [\"liver\", \"spine\"]\nstiffness = 1e5\n")),
             Contains(":11: ") && Contains("'spine' is not served yet") && Contains("\"surroundings\""));
  CHECK_THAT(errorOf(attached("bodies = [\"liver\"]\nstiffness = 1e5\n")),
             Contains("bodies is [\"liver\"]; accepted: two names"));
  CHECK_THAT(errorOf(attached("bodies = [\"live\", \"surroundings\"]\nstiffness = 1e5\n")),
             Contains("no body 'live'") && Contains("did you mean 'liver'"));
  CHECK_THAT(errorOf(attached(surroundings)), Contains("no 'stiffness'") && Contains("Pa/m"));
  CHECK_THAT(errorOf(attached("stiffness = 1\n")), Contains("no 'bodies'"));
  CHECK_THAT(errorOf(attached(surroundings + "stiffness = 1e5\ntears_at = 100\n")),
             Contains("tears is not served yet"));
  CHECK_THAT(errorOf(attached(surroundings + "stiffness = 1e5\nwithin_mm = 3\n")),
             Contains("'within_mm' is not served yet"));
  CHECK_THAT(errorOf(attached(surroundings + "stifness = 1e5\n")), Contains("did you mean 'stiffness'"));
  CHECK_THAT(errorOf(attached(surroundings + "stiffness = 1e5\n[[attachment]]\n" + surroundings + "stiffness = 2e5\n")),
             Contains("a second attachment holds 'liver'"));
}

TEST_CASE("The hold of the surroundings and rigid are set from the command line", "[scene][attachment]") {
  auto scene = parse(attached("bodies = [\"liver\", \"surroundings\"]\nstiffness = 1e5\n"));
  REQUIRE(scene.has_value());
  REQUIRE(scene::applyOverride(*scene, "body.liver.surroundings.stiffness=3e5", &presets()));
  REQUIRE(scene::applyOverride(*scene, "body.spine.rigid=true", &presets()));
  CHECK(findValue(scene->bodies[0].params, "surroundings.stiffness")->value.num == 3e5);
  CHECK(findValue(scene->bodies[1].params, "rigid")->value.num == 1.0);
}

TEST_CASE("What stays in an image is automatic, nothing, all outside of bodies, or by labels and values",
          "[scene][still]") {
  const auto still = [](const std::string &lines) {
    const auto scene = parse(imaged(lines));
    INFO((scene ? std::string() : scene.error().message));
    REQUIRE(scene.has_value());
    return scene->image->still;
  };
  CHECK(still("") == scene::SceneStill{});
  CHECK(still("").isAutomatic);
  CHECK(still("still = \"auto\"\n").isAutomatic);
  CHECK(still("still = \"nothing\"\n") == scene::SceneStill{false, {}, {}, {}, false});
  CHECK(still("still = \"outside\"\n") == scene::SceneStill{false, {}, {}, {}, true});
  CHECK(still("labels = \"block.obj\"\nstill = { labels = [\"rib*\", 5], above = 200, below = -400.5 }\n") ==
        scene::SceneStill{false, 200.0, -400.5, {"rib*", "5"}, false});
  CHECK(still("still = { outside = true }\n").outside);
}

TEST_CASE("Bad values of what stays are refused with what is accepted", "[scene][still]") {
  CHECK_THAT(errorOf(imaged("still = \"bone\"\n")), Contains("still is \"bone\"") && Contains("\"outside\""));
  CHECK_THAT(errorOf(imaged("still = 3\n")), Contains("accepted:"));
  CHECK_THAT(errorOf(imaged("still = {}\n")), Contains("an empty table"));
  CHECK_THAT(errorOf(imaged("still = { over = 3 }\n")), Contains("unknown key 'over'") && Contains("above"));
  CHECK_THAT(errorOf(imaged("still = { above = \"x\" }\n")), Contains("still.above is the text \"x\""));
  CHECK_THAT(errorOf(imaged("still = { above = nan }\n")), Contains("still.above"));
  CHECK_THAT(errorOf(imaged("still = { above = 100, below = 200 }\n")), Contains("leave nothing that moves"));
  CHECK_THAT(errorOf(imaged("still = { labels = [\"rib*\"] }\n")), Contains("there is no 'labels'"));
  CHECK_THAT(errorOf(imaged("labels = \"block.obj\"\nstill = { labels = [0] }\n")), Contains("1 … 65535"));
  CHECK_THAT(errorOf(imaged("labels = \"block.obj\"\nstill = { labels = [] }\n")), Contains("names of labels"));
}
