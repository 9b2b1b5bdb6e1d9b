// SPDX-License-Identifier: Apache-2.0
// Attachments that hold bodies at their position in the scan, rigid tissue, and static parts of an image.
#include "scene_text.h"

using namespace c3de;

namespace {

const std::string kTwo =
    kMinimal + "name = \"liver\"\n[[body]]\nname = \"spine\"\nmesh = \"block.obj\"\nmesh_unit = \"m\"\n";

std::string attached(const std::string &lines) { return kTwo + "[[attachment]]\n" + lines; }
std::string imaged(const std::string &lines) { return kMinimal + "[image]\nfile = \"beam.obj\"\n" + lines; }

}  // namespace

TEST_CASE("An attachment to the surroundings is parameters of its body", "[scene][attachment]") {
  // Also before the body that it holds.
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

TEST_CASE("An attachment between bodies, in a region or that tears, is one of the scene", "[scene][attachment]") {
  const auto read = parse(attached(
      "bodies = [\"liver\", \"spine\"]\nwithin_mm = 3\nstiffness = 1e5\ntears_at = 2e3\n"
      "[[attachment]]\nname = \"foot\"\nbodies = [\"liver\", \"surroundings\"]\nstiffness = 1e4\ntangential = 0\n"
      "region = { sphere = { centre = [0, 0, 0], radius = 0.1 } }\n"));
  REQUIRE(read.has_value());
  REQUIRE(read->attachments.size() == 2);
  const scene::SceneAttachment &layer = read->attachments[0], &foot = read->attachments[1];
  CHECK(layer.name == "liver/spine");
  CHECK(layer.names == std::array<std::string, 2>{"liver", "spine"});
  CHECK(layer.within_m == 0.003);
  CHECK(layer.stiffness_Pa_m == 1e5);
  CHECK(layer.tangential_Pa_m() == 1e5);
  CHECK(layer.tearsAt_Pa == 2e3);
  CHECK_FALSE(layer.region.has_value());
  CHECK(foot.name == "foot");
  CHECK(foot.names[1] == "surroundings");
  CHECK(foot.tangential_Pa_m() == 0.0);
  REQUIRE(foot.region.has_value());
  CHECK(foot.region->radius == 0.1);
  CHECK(findValue(read->bodies[0].params, "surroundings.stiffness") == nullptr);

  scene::SceneFile changed = *read;
  REQUIRE(scene::applyOverride(changed, "attachment.foot.stiffness=2e4", nullptr));
  CHECK(changed.attachments[1].stiffness_Pa_m == 2e4);
  REQUIRE(scene::applyOverride(changed, "attachment.0.within_mm=5", nullptr));
  CHECK(changed.attachments[0].within_m == 0.005);
  CHECK_THAT(scene::applyOverride(changed, "attachment.0.within_mm=0", nullptr).error().message,
             Contains("within_mm is 0") && Contains("above 0, mm"));
  CHECK_THAT(scene::applyOverride(changed, "attachment.feet.stiffness=1", nullptr).error().message,
             Contains("did you mean 'foot'"));
}

TEST_CASE("An attachment that cannot be or says too little is refused by name", "[scene][attachment]") {
  const std::string surroundings = "bodies = [\"liver\", \"surroundings\"]\n",
                    spine = "bodies = [\"liver\", \"spine\"]\n";
  CHECK_THAT(errorOf(attached("bodies = [\"liver\", \"spin\"]\nwithin_mm = 3\nstiffness = 1e5\n")),
             Contains(":10: ") && Contains("no body or obstacle 'spin'") && Contains("did you mean 'spine'"));
  CHECK_THAT(errorOf(attached("bodies = [\"liver\"]\nstiffness = 1e5\n")),
             Contains("bodies is [\"liver\"]; accepted: two names"));
  CHECK_THAT(errorOf(attached("bodies = [\"live\", \"surroundings\"]\nstiffness = 1e5\n")),
             Contains("no body 'live'") && Contains("did you mean 'liver'"));
  CHECK_THAT(errorOf(attached("bodies = [\"liver\", \"liver\"]\nwithin_mm = 3\nstiffness = 1e5\n")),
             Contains("'liver' twice"));
  CHECK_THAT(errorOf(attached(surroundings)), Contains("no 'stiffness'") && Contains("Pa/m"));
  CHECK_THAT(errorOf(attached("stiffness = 1\n")), Contains("no 'bodies'"));
  CHECK_THAT(errorOf(attached(spine + "stiffness = 1e5\n")),
             Contains("does not say where") && Contains("within_mm") && Contains("region"));
  CHECK_THAT(errorOf(attached(surroundings + "stiffness = 1e5\nwithin_mm = 3\n")),
             Contains("applies to two surfaces") && Contains("region"));
  CHECK_THAT(errorOf(attached(spine + "within_mm = 3\nstiffness = -1\n")),
             Contains("stiffness is -1") && Contains("at least 0, Pa/m"));
  CHECK_THAT(errorOf(attached(spine + "within_mm = 3\nstiffness = 1e5\ntears_at = -2\n")), Contains("tears_at is -2"));
  CHECK_THAT(errorOf(attached(spine + "within_mm = 3\nstiffness = 1e5\nretardation_time = 0.1\n")),
             Contains("retardation_time is of an attachment of all of the surface"));
  CHECK_THAT(errorOf(attached(surroundings + "stifness = 1e5\n")), Contains("did you mean 'stiffness'"));
  CHECK_THAT(errorOf(attached(surroundings + "stiffness = 1e5\n[[attachment]]\n" + surroundings + "stiffness = 2e5\n")),
             Contains("a second attachment holds all of 'liver'"));
  const std::string layer = spine + "within_mm = 3\nstiffness = 1e5\n";
  CHECK_THAT(errorOf(attached(layer + "[[attachment]]\n" + layer)),
             Contains("a second attachment is named 'liver/spine'"));
}

TEST_CASE("A stiffness across that nobody has said follows the one along the normal", "[scene][attachment]") {
  const std::string layer = "bodies = [\"liver\", \"spine\"]\nwithin_mm = 3\nstiffness = 1e5\n";
  auto scene = parse(attached(layer));
  REQUIRE(scene.has_value());
  REQUIRE(scene::applyOverride(*scene, "attachment.liver/spine.stiffness=2e6", &presets()));
  CHECK(scene->attachments[0].stiffness_Pa_m == 2e6);
  CHECK(scene->attachments[0].tangential_Pa_m() == 2e6);
  REQUIRE(scene::applyOverride(*scene, "attachment.liver/spine.tangential=3e5", &presets()));
  REQUIRE(scene::applyOverride(*scene, "attachment.liver/spine.stiffness=4e6", &presets()));
  CHECK(scene->attachments[0].tangential_Pa_m() == 3e5);
  auto said = parse(attached(layer + "tangential = 5e4\n"));
  REQUIRE(said.has_value());
  REQUIRE(scene::applyOverride(*said, "attachment.liver/spine.stiffness=2e6", &presets()));
  CHECK(said->attachments[0].tangential_Pa_m() == 5e4);
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
  CHECK(still("") == scene::SceneFixedRegions{});
  CHECK(still("").isAutomatic);
  CHECK(still("still = \"auto\"\n").isAutomatic);
  CHECK(still("still = \"nothing\"\n") == scene::SceneFixedRegions{false, {}, {}, {}, false});
  CHECK(still("still = \"outside\"\n") == scene::SceneFixedRegions{false, {}, {}, {}, true});
  CHECK(still("labels = \"block.obj\"\nstill = { labels = [\"rib*\", 5], above = 200, below = -400.5 }\n") ==
        scene::SceneFixedRegions{false, 200.0, -400.5, {"rib*", "5"}, false});
  CHECK(still("still = { outside = true }\n").outside);
}

TEST_CASE("Bad values of what stays are refused with what is accepted", "[scene][still]") {
  CHECK_THAT(errorOf(imaged("still = \"bone\"\n")), Contains("still is \"bone\"") && Contains("\"outside\""));
  CHECK_THAT(errorOf(imaged("still = 3\n")), Contains("accepted:"));
  CHECK_THAT(errorOf(imaged("still = {}\n")), Contains("an empty table"));
  CHECK_THAT(errorOf(imaged("still = { over = 3 }\n")), Contains("unknown key 'over'") && Contains("above"));
  CHECK_THAT(errorOf(imaged("still = { above = \"x\" }\n")), Contains("still.above is the text \"x\""));
  CHECK_THAT(errorOf(imaged("still = { above = nan }\n")), Contains("still.above"));
  CHECK_THAT(errorOf(imaged("still = { above = 100, below = 200 }\n")), Contains("select nothing that moves"));
  CHECK_THAT(errorOf(imaged("still = { labels = [\"rib*\"] }\n")), Contains("'labels', their file, is missing"));
  CHECK_THAT(errorOf(imaged("labels = \"block.obj\"\nstill = { labels = [0] }\n")), Contains("a whole number from 1"));
  CHECK_THAT(errorOf(imaged("labels = \"block.obj\"\nstill = { labels = [] }\n")), Contains("names of labels"));
}
