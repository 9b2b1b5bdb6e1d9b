// SPDX-License-Identifier: Apache-2.0
// Tissues that slide on the rest of their body: pieces with settings of their own.
#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/imaging/writing.h"
#include "program.h"
#include "support/catch.h"

using namespace c3de;
using Catch::Matchers::Contains;

namespace {

/// Two blocks of 128 x 64 x 32 mm on each other, in voxels of 4 mm, the border between them at z = 32 mm.
void writeBlocks(const std::filesystem::path &file) {
  imaging::LabelMap map;
  map.geometry.size = {34, 18, 18};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  for (const std::size_t axis : {12, 13, 14}) map.geometry.indexToWorld[axis] = -2.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 17; ++k)
    for (std::size_t j = 1; j < 17; ++j)
      for (std::size_t i = 1; i < 33; ++i) map.voxels[i + 34 * (j + 18 * k)] = k < 9 ? 1 : 2;
  map.labels = {{1, "below", {0.6F, 0.2F, 0.1F}}, {2, "above", {0.2F, 0.6F, 0.1F}}};
  REQUIRE(imaging::writeLabelMap(file, map));
}

/// Held at the bottom; the block above is pushed along x by half of its weight.
std::string blocksScene(const std::string &slides, const std::string &world = "gravity = [0, 0, -9.81]\n") {
  return "format = 1\n[world]\n" + world +
         "[[body]]\nname = \"scan\"\nvolume = \"blocks.nrrd\"\nsampling = { spacing = 0.008 }\n" + slides +
         "tissues = [ { label = \"below\", material = { youngs_modulus = 1e5, density = 1000, viscosity = 50 } }, "
         "{ label = \"above\", material = { youngs_modulus = 1e5, density = 1000, viscosity = 50 } } ]\n"
         "[[fix]]\nbody = \"scan\"\nregion = { box = { min = [-1, -1, -1], max = [1, 1, 0.004] } }\n"
         "[[load]]\nname = \"push\"\nbody = \"scan\"\nregion = { box = { min = [-1, -1, 0.0325], max = [1, 1, 1] } }\n"
         "force = [1.286, 0, 0]\n";
}

}  // namespace

TEST_CASE("A layer that slides without friction is pushed aside as a free body and a glued one shears", "[tissues]") {
  const auto folder = freshFolder("tissues-slide");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene = writeFile(folder / "scene.toml", blocksScene("slides = [\"above\"]\nslide_friction = 0\n"));
  const auto table = folder / "tissues.csv";
  const double t = 0.06, mass = 1000.0 * 128e-3 * 64e-3 * 32e-3, weight = 9.81 * mass, push = 1.286;
  const auto moved = [&](const nlohmann::json &report, const char *piece) {
    for (const auto &body : report["bodies"])
      if (body["name"] == piece) return body["centre_of_mass_m"][0].get<double>();
    FAIL("no body " + std::string(piece));
    return 0.0;
  };
  const auto report = runToReport(scene, {"--until", std::to_string(t), "--tissues", table.string()});
  REQUIRE(report["bodies"].size() == 2);
  CHECK(report["bodies"][1]["name"] == "scan.above");
  CHECK(report["bodies"][1]["mass_kg"].get<double>() == Approx(mass).epsilon(1e-3));
  // Half a F/m t². Skins are not flat: bulges of 0.3 mm over edges of 6 mm that climb each other resist by some 0.05 of
  // the pressing force, here of the weight; half as much again is allowed.
  const double s = report["time_s"].get<double>(), free = 0.5 * push / mass * s * s;
  const double slid = moved(report, "scan.above") - 0.064;
  CHECK(slid < 1.01 * free);
  CHECK(slid > free * (1.0 - 0.075 * weight / push));
  REQUIRE(report["contacts"].size() == 1);
  CHECK(report["contacts"][0]["bodies"] == nlohmann::json{"scan", "scan.above"});
  CHECK(std::abs(report["contacts"][0]["force_N"][0].get<double>()) < 0.075 * weight);
  CHECK(-report["contacts"][0]["force_N"][2].get<double>() == Approx(weight).epsilon(0.1));
  const std::string rows = readFile(table);
  CHECK_THAT(rows, Contains("\nscan,1,below,") && Contains("\nscan.above,2,above,"));
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 3);

  // Without weight there is no shear: the loss is from initial overlap with the other's bulges.
  const auto light = runToReport(scene, {"--until", "0.06", "--set", "world.gravity=[0, 0, 0]"});
  CHECK(moved(light, "scan.above") - 0.064 == Approx(free).epsilon(0.05));

  // Coulomb friction on the border, in addition.
  const auto rough = runToReport(scene, {"--until", "0.06", "--set", "body.scan.slide_friction=0.3"});
  const double slowed = free * (1.0 - 0.3 * weight / push);
  CHECK(moved(rough, "scan.above") - 0.064 < slowed);
  CHECK(moved(rough, "scan.above") - 0.064 > slowed - free * 0.075 * weight / push);

  const auto glued = runToReport(writeFile(folder / "glued.toml", blocksScene("")), {"--until", "0.06"});
  REQUIRE(glued["bodies"].size() == 1);
  CHECK(glued["contacts"].empty());
  // The mean of all points, half of which are near the support: less than a twentieth of the sliding distance.
  CHECK(std::abs(moved(glued, "scan") - 0.064) < 0.05 * free);
}

TEST_CASE("A piece of what slides is set by the name that the report says", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-set");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene = writeFile(folder / "scene.toml", blocksScene("slides = [\"above\"]\n"));
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"--steps", "1"});
    return runToReport(scene, more)["bodies"];
  };
  const auto as = run({});
  const auto set =
      run({"--set", "body.scan.above.material.density=500", "--set", "body.scan.above.sampling.spacing=0.016"});
  REQUIRE(set.size() == 2);
  CHECK(set[0]["mass_kg"] == as[0]["mass_kg"]);
  CHECK(set[0]["phyxels"] == as[0]["phyxels"]);
  CHECK(set[1]["mass_kg"].get<double>() == Approx(0.5 * as[1]["mass_kg"].get<double>()));
  CHECK(set[1]["phyxels"].get<int>() < as[1]["phyxels"].get<int>() / 4);
  // In a body with a given point count, a piece without a setting has the spacing of the rest, a piece with one has its
  // own.
  const auto counted = run({"--set", "body.scan.sampling.count=2000", "--set", "body.scan.above.sampling.count=100"});
  CHECK(counted[1]["phyxels"].get<int>() < counted[0]["phyxels"].get<int>() / 4);

  const auto refusal = [&](const std::string &assignment) {
    const auto refused = runC3de({"run", scene.string(), "--steps", "1", "--set", assignment});
    CHECK(refused.exitCode == 2);
    return refused.errorOutput;
  };
  CHECK_THAT(refusal("body.scan.abov.material.density=500"),
             Contains("there is no piece 'scan.abov'; did you mean 'scan.above'? accepted: scan.above"));
  CHECK_THAT(refusal("body.scan.above.material.densty=500"),
             Contains("--set body.scan.above.material.densty") && Contains("did you mean 'material.density'?"));
  CHECK_THAT(refusal("body.scan.above.position=[0,0,0]"), Contains("cannot be set for a piece; accepted: material"));
}

TEST_CASE("Pieces and the rest are rigid, free or thrown each by itself, and the rest has a name", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-pieces");
  writeBlocks(folder / "blocks.nrrd");
  const std::string slides = "slides = [\"above\"]\nslide_friction = 0\n", text = blocksScene(slides);
  const auto scene = writeFile(folder / "scene.toml", text);
  const auto run = [&](const std::filesystem::path &what, const std::vector<std::string> &set, double until_s = 0.02) {
    std::vector<std::string> more{"--until", std::to_string(until_s)};
    for (const std::string &one : set) more.insert(more.end(), {"--set", one});
    return runToReport(what, more);
  };
  const auto centre = [](const nlohmann::json &report, std::size_t body, std::size_t axis) {
    return report["bodies"][body]["centre_of_mass_m"][axis].get<double>();
  };
  const auto as = run(scene, {});
  REQUIRE(as["bodies"].size() == 2);

  // It is static, and the body pushed against it does not pass through.
  const auto standing = run(scene, {"body.scan.above.rigid=true", "body.scan.velocity=[0, 0, 0.1]"});
  for (std::size_t axis = 0; axis < 3; ++axis)
    CHECK(centre(standing, 1, axis) == Approx(axis == 0 ? 0.064 : axis == 1 ? 0.032 : 0.048).margin(1e-12));
  // It moves like the soft one, half a F/m t² less the resistance of the bulges, and keeps its shape.
  const double pushed = centre(as, 1, 0) - 0.064;
  const auto free = run(scene, {"body.scan.above.free=true", "body.scan.above.rigid=true"});
  CHECK(pushed > 5e-4);
  CHECK(centre(free, 1, 0) - 0.064 == Approx(pushed).epsilon(0.15));
  CHECK(free["bodies"][1]["energy_J"]["elastic"] == 0.0);
  CHECK(free["bodies"][0]["energy_J"]["elastic"] > 0.0);
  // Each separately.
  const std::vector<std::string> light{"world.gravity=[0, 0, 0]", "load.push.force=[0, 0, 0]"};
  const auto thrown = [&](std::string set, double until_s) {
    std::vector<std::string> all = light;
    all.push_back(std::move(set));
    return run(scene, all, until_s);
  };
  const auto above = thrown("body.scan.above.velocity=[0, 0.1, 0]", 0.01),
             rest = thrown("body.scan.rest.velocity=[0, 0.1, 0]", 1e-4);
  CHECK(centre(above, 1, 1) - 0.032 == Approx(1e-3).epsilon(0.05));
  CHECK(std::abs(centre(above, 0, 1) - 0.032) < 5e-5);
  const double mass = rest["bodies"][0]["mass_kg"].get<double>();
  CHECK(rest["bodies"][0]["momentum"][1].get<double>() > 0.7 * 0.1 * mass);  // it is held at the bottom
  CHECK(std::abs(rest["bodies"][1]["momentum"][1].get<double>()) < 0.05 * 0.1 * mass);

  // A setting of the rest applies to nothing else.
  const auto set = run(scene, {"body.scan.rest.material.density=500", "body.scan.rest.sampling.spacing=0.016"}, 1e-4);
  CHECK(set["bodies"][0]["mass_kg"].get<double>() == Approx(0.5 * as["bodies"][0]["mass_kg"].get<double>()));
  CHECK(set["bodies"][0]["phyxels"].get<int>() < as["bodies"][0]["phyxels"].get<int>() / 4);
  CHECK(set["bodies"][1]["mass_kg"] == as["bodies"][1]["mass_kg"]);
  CHECK(set["bodies"][1]["phyxels"] == as["bodies"][1]["phyxels"]);
  const std::string fix = "[[fix]]\nbody = \"scan\"\n", pair = "[[contact.pair]]\nfriction = 0.3\nbodies = [\"scan";
  REQUIRE(text.find(fix) != std::string::npos);
  std::string all = text, alone = text;
  all += pair + "\", \"scan.above\"]\n";
  alone.replace(alone.find(fix), fix.size(), "[[fix]]\nbody = \"scan.rest\"\n");
  alone += pair + ".rest\", \"scan.above\"]\n";
  const auto whole = run(writeFile(folder / "all.toml", all), {}),
             other = run(writeFile(folder / "rest.toml", alone), {});
  CHECK(whole["state_hash"] == other["state_hash"]);
  CHECK(whole["state_hash"] != as["state_hash"]);
  REQUIRE(other["contacts"].size() == 1);
  CHECK(other["contacts"][0]["bodies"] == nlohmann::json{"scan", "scan.above"});
  // A fix of both acts on the part that is not static already.
  std::string both = text;
  both.replace(both.find("0.004] } }"), 10, "0.004] } }\n[[fix]]\nbody = \"scan\"\nregion = { everywhere = true }");
  const auto held = run(writeFile(folder / "both.toml", both), {"body.scan.above.rigid=true"}, 1e-3);
  REQUIRE(held["reactions"].size() == 2);
  CHECK(held["reactions"][1]["body"] == "scan");

  const auto refusal = [&](const std::vector<std::string> &assignments) {
    std::vector<std::string> arguments{"run", scene.string(), "--steps", "1"};
    for (const std::string &one : assignments) arguments.insert(arguments.end(), {"--set", one});
    const auto refused = runC3de(arguments);
    CHECK(refused.exitCode == 2);
    return refused.errorOutput;
  };
  CHECK_THAT(refusal({"body.scan.above.free=true"}),
             Contains("--set body.scan.above.free: 'scan.above' deforms, and moves freely where nothing holds it; "
                      "accepted: free = true of what is rigid, --set body.scan.above.rigid=true"));
  CHECK_THAT(refusal({"body.scan.rest.velocity=[0, 0, 1]", "body.scan.rest.rigid=true"}),
             Contains("'scan.rest' has a velocity and is rigid, which stands in its place; accepted: one of them, or "
                      "--set body.scan.rest.free=true"));
  CHECK_THAT(refusal({"body.scan.rigid=true"}), Contains("of pieces: PIECE.rigid, pieces: scan.above, scan.rest"));
  CHECK_THAT(refusal({"body.scan.rst.rigid=true"}),
             Contains("there is no piece 'scan.rst'; did you mean 'scan.rest'? accepted: scan.above, scan.rest"));
}

TEST_CASE("Rigid tissue of a piece that is rigid does what all of it does", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-bone");
  imaging::LabelMap map;
  map.geometry.size = {18, 18, 26};
  for (const std::size_t axis : {0, 5, 10}) map.geometry.indexToWorld[axis] = 4.0;
  map.voxels.assign(map.geometry.voxelCount(), 0);
  for (std::size_t k = 1; k < 25; ++k)
    for (std::size_t j = 1; j < 17; ++j)
      for (std::size_t i = 1; i < 17; ++i) map.voxels[i + 18 * (j + 18 * k)] = k < 9 ? 3 : k < 17 ? 1 : 2;
  map.labels = {{1, "below", {0.6F, 0.2F, 0.1F}}, {2, "above", {0.2F, 0.6F, 0.1F}}, {3, "bone", {0.9F, 0.9F, 0.6F}}};
  REQUIRE(imaging::writeLabelMap(folder / "blocks.nrrd", map));
  const auto scene =
      writeFile(folder / "scene.toml",
                "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"scan\"\nvolume = \"blocks.nrrd\"\n"
                "slides = [\"above\"]\nsampling = { spacing = 0.008 }\n"
                "tissues = [ { label = \"below\", material = \"liver\" }, { label = \"above\", material = \"liver\" }, "
                "{ label = \"bone\", rigid = true } ]\n");
  const auto as = runToReport(scene, {"--until", "0.01"});
  REQUIRE(as["reactions"].size() == 1);
  // Cells of 8 mm are of bone or not: 9 x 9 corners in 5 layers over 32 mm, of which the uppermost is of both.
  CHECK(as["bodies"][0]["phyxels"] == 9 * 9 * 9);
  CHECK(as["bodies"][0]["held_phyxels"] == 9 * 9 * 4);
  CHECK(as["bodies"][1]["held_phyxels"] == 0);
  CHECK_THAT(as["notices"].dump(), Contains("body 'scan': 324 of its 729 phyxels are held, in rigid tissue") &&
                                       !Contains("body 'scan.above': 0 of"));
  const auto standing = runToReport(scene, {"--until", "0.01", "--set", "body.scan.rest.rigid=true"});
  CHECK(standing["reactions"].empty());
  const double dropped =
      as["bodies"][0]["centre_of_mass_m"][2].get<double>() - standing["bodies"][0]["centre_of_mass_m"][2].get<double>();
  CHECK(dropped < 0.0);
  const auto falling = runToReport(
      scene, {"--until", "0.01", "--set", "body.scan.rest.rigid=true", "--set", "body.scan.rest.free=true"});
  const double t = falling["time_s"].get<double>();
  CHECK(standing["bodies"][0]["centre_of_mass_m"][2].get<double>() -
            falling["bodies"][0]["centre_of_mass_m"][2].get<double>() ==
        Approx(0.5 * 9.81 * t * t).epsilon(0.1));
}

TEST_CASE("Pieces in balance with the gravity of the scan stay where they are", "[tissues]") {
  const auto folder = freshFolder("tissues-slide-rest");
  writeBlocks(folder / "blocks.nrrd");
  const auto scene =
      writeFile(folder / "scene.toml",
                blocksScene("slides = [\"above\"]\n", "gravity = [0, 0, -9.81]\nscan_gravity = [0, 0, -9.81]\n"));
  const auto report = runToReport(scene, {"--until", "0.5", "--set", "load.push.force=[0, 0, 0]"});
  REQUIRE(report["bodies"].size() == 2);
  // Nothing presses, so nothing moves.
  for (const auto &body : report["bodies"]) {
    REQUIRE(body["tissues"].size() == 1);
    CHECK(body["tissues"][0]["displacement_m"]["max"].get<double>() < 1e-6);
  }
  for (const auto &event : report["events"]) CHECK(event["kind"] != "warning");
}
