// SPDX-License-Identifier: Apache-2.0
// Jaws that grasp tissue without user input.
#include "scene_text.h"

using namespace c3de;

namespace {

std::string grasped(const std::string &lines) { return kMinimal + "[[grasp]]\n" + lines; }
const std::string kHere = "at = [0, 1, 0]\naxis = [2, 0, 0]\n";

}  // namespace

TEST_CASE("A grasp has jaws, and a path if it is led", "[scene][grasp]") {
  const auto scene = parse(grasped("name = \"tongs\"\n" + kHere +
                                   "jaw_mm = 8\nopening_mm = 24\nclosed_mm = 6\nforce_limit = 0.5\n"
                                   "path = [ { time = 0.3, at = [0, 1, 0] }, { time = 1, at = [0, 1.1, 0], turn_deg = "
                                   "[0, 0, 30] } ]\n") +
                           "[[grasp]]\njaw_mm = 12\n" + kHere);
  REQUIRE(scene.has_value());
  REQUIRE(scene->grasps.size() == 2);
  const scene::SceneGrasp &tongs = scene->grasps[0];
  CHECK(tongs.name == "tongs");
  CHECK(tongs.body == scene->bodies[0].name);  // the only one
  CHECK(tongs.axis == Vec3{2, 0, 0});
  CHECK(tongs.jaw_m == 0.008);
  CHECK(tongs.opening_m() == 0.024);
  CHECK(tongs.closed_m() == 0.006);
  CHECK(tongs.forceLimit_N == 0.5);
  REQUIRE(tongs.path.size() == 2);
  CHECK(tongs.path[0].turn_deg == Vec3{});
  CHECK(tongs.path[1].turn_deg == Vec3{0, 0, 30});
  // Unspecified values follow from the jaws.
  CHECK(scene->grasps[1].name == "grasp-2");
  CHECK(scene->grasps[1].opening_m() == 0.024);
  CHECK(scene->grasps[1].closed_m() == 0.012);
  CHECK(scene->grasps[1].forceLimit_N == 0.0);
  CHECK(scene->grasps[1].path.empty());
}

TEST_CASE("The opening and the gap of jaws follow what is set, unless they have been said", "[scene][grasp]") {
  auto scene = parse(grasped("name = \"tongs\"\n" + kHere + "jaw_mm = 8\n"));
  REQUIRE(scene.has_value());
  const auto tongs = [&]() -> const scene::SceneGrasp & { return scene->grasps[0]; };
  // Before, the opening stayed at 16 mm, and a jaw of 30 was refused.
  REQUIRE(scene::applyOverride(*scene, "grasp.tongs.jaw_mm=30", &presets()));
  CHECK(tongs().opening_m() == 0.06);
  CHECK(tongs().closed_m() == 0.03);
  REQUIRE(scene::applyOverride(*scene, "grasp.tongs.opening_mm=80", &presets()));
  CHECK(tongs().closed_m() == 0.04);
  REQUIRE(scene::applyOverride(*scene, "grasp.tongs.closed_mm=10", &presets()));
  REQUIRE(scene::applyOverride(*scene, "grasp.tongs.opening_mm=70", &presets()));
  CHECK(tongs().closed_m() == 0.01);
}

TEST_CASE("A grasp that says too little or what cannot be is refused", "[scene][grasp]") {
  CHECK_THAT(errorOf(grasped("axis = [1, 0, 0]\n")),
             Contains("test.toml:5: the grasp has no 'at'; accepted: a material"));
  CHECK_THAT(errorOf(grasped("at = [0, 1, 0]\n")), Contains("the grasp has no 'axis'"));
  CHECK_THAT(errorOf(grasped("at = [0, 1, 0]\naxis = [0, 0, 0]\n")), Contains(":7: axis is [0, 0, 0]; accepted: "));
  CHECK_THAT(errorOf(grasped(kHere + "jaw_mm = 0\n")), Contains(":8: jaw_mm is 0; accepted: a number above 0, mm"));
  CHECK_THAT(errorOf(grasped(kHere + "jaw_mm = 30\nopening_mm = 20\n")),
             Contains("opening_mm is 20 and jaw_mm is 30") && Contains("at least jaw_mm"));
  CHECK_THAT(errorOf(grasped(kHere + "closed_mm = 25\n")), Contains("closed_mm is 25; accepted: 0 to opening_mm, 20"));
  CHECK_THAT(errorOf(grasped(kHere + "closed_mm = -1\n")), Contains("closed_mm is -1"));
  CHECK_THAT(errorOf(grasped(kHere + "force_limit = -1\n")),
             Contains("force_limit is -1; accepted: a number of at least 0, N"));
  CHECK_THAT(errorOf(grasped(kHere + "jaws_mm = 3\n")),
             Contains("unknown key 'jaws_mm' in [[grasp]]") && Contains("did you mean 'jaw_mm'"));
  CHECK_THAT(errorOf(grasped(kHere + "body = \"lung\"\n")), Contains("'lung'"));
  const auto path = [&](const std::string &places) { return errorOf(grasped(kHere + "path = [ " + places + " ]\n")); };
  CHECK_THAT(path("{ time = 1, at = [0, 1, 0] }, { time = 1, at = [0, 0, 0] }"), Contains("times that ascend"));
  CHECK_THAT(path("{ time = 1, at = [0, 1, 0], turn_deg = 3 }"), Contains("turn_deg is"));
  CHECK_THAT(path("{ time = 1, at = [0, 1, 0], axis = [0, 0, 1] }"), Contains("unknown key 'axis'"));
  CHECK_THAT(errorOf(grasped("name = \"a\"\n" + kHere + "[[grasp]]\nname = \"a\"\n" + kHere)),
             Contains("a second grasp is named 'a'"));
}

TEST_CASE("A grasp is changed from the command line", "[scene][grasp]") {
  auto scene = parse(grasped("name = \"tongs\"\n" + kHere));
  REQUIRE(scene.has_value());
  const auto set = [&](const std::string &assignment) { return scene::applyOverride(*scene, assignment, &presets()); };
  const auto refusal = [&](const std::string &assignment) {
    const auto done = set(assignment);
    return done ? std::string() : done.error().message;
  };
  REQUIRE(set("grasp.tongs.force_limit=0.2"));
  CHECK(scene->grasps[0].forceLimit_N == 0.2);
  REQUIRE(set("grasp.0.path=[{time=0,at=[0,0,0]}]"));
  CHECK(scene->grasps[0].path.size() == 1);
  CHECK_THAT(refusal("grasp.tongs.name=a"), Contains("cannot be changed"));
  CHECK_THAT(refusal("grasp.tong.jaw_mm=4"), Contains("did you mean 'tongs'"));
  REQUIRE(set("grasp.tongs.opening_mm=20"));
  CHECK_THAT(refusal("grasp.tongs.jaw_mm=40"), Contains("at least jaw_mm"));
  CHECK_THAT(refusal("grasp.tongs.jaws_mm=4"), Contains("did you mean 'jaw_mm'"));
}
