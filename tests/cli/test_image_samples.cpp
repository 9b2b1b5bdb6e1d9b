// SPDX-License-Identifier: Apache-2.0
// The example plugins/image_samples without a window: images and parameters are available, and its lines are in the
// log.
#include <regex>

#include "c3de/imaging/writing.h"
#include "program.h"

using namespace c3de;

namespace {

std::string example(const std::string &name) {
  return (std::filesystem::path(testExampleFolder()) / (name + pluginExtension())).string();
}

/// A box of 1000 x 200 x 200 mm in an image whose values are x in mm.
std::filesystem::path writeRampScene(const std::filesystem::path &folder) {
  imaging::Volume ramp;
  ramp.unit = "HU";
  ramp.geometry.size = {7, 7, 7};
  ramp.geometry.indexToWorld = {400, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, -700, -200, -200, 1};
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 49; ++k)
    for (int i = 0; i < 7; ++i) voxels.push_back(static_cast<std::int16_t>(-700 + 400 * i));
  ramp.voxels = voxels;
  REQUIRE(imaging::writeVolume(folder / "ramp.nrrd", ramp));
  return writeBoxScene(folder, "[image]\nfile = \"ramp.nrrd\"\n");
}

}  // namespace

TEST_CASE("A plugin reads the image of the scene at the points of bodies, without a window") {
  const auto folder = freshFolder("image-samples");
  const auto scene = writeRampScene(folder);
  const auto run = runC3de({"run", scene.string(), "--steps", "3", "--plugin", example("image_samples"), "--set",
                            "world.gravity=[0,0,0]", "--plugin-param", "org.c3de.image_samples:every=0"});
  INFO(run.output + run.errorOutput);
  REQUIRE(run.exitCode == 0);
  const std::string log = run.output + run.errorOutput;
  std::smatch found;
  REQUIRE(
      std::regex_search(log, found, std::regex(R"(mean (\S+), (\S+) to (\S+) \S* ?at (\d+) points, (\d+) outside)")));
  CHECK_THAT(std::stod(found[1]), WithinAbs(500.0, 5.0));
  CHECK_THAT(std::stod(found[2]), WithinAbs(0.0, 60.0));
  CHECK_THAT(std::stod(found[3]), WithinAbs(1000.0, 60.0));
  CHECK(std::stoi(found[4]) > 100);
  CHECK(found[5] == "0");

  // Without an image there is no output, and that is no error.
  const auto none = runC3de({"run", writeBoxScene(freshFolder("image-samples-none")).string(), "--steps", "2",
                             "--plugin", example("image_samples")});
  CHECK(none.exitCode == 0);
  CHECK((none.output + none.errorOutput).find("mean ") == std::string::npos);
}

TEST_CASE("c3de plugins says what --plugin-param takes, and which files a plugin reads and writes") {
  const auto text =
      runC3de({"plugins", "--no-plugins", "--plugin", example("magnet"), "--plugin", example("mesh_reader")});
  INFO(text.errorOutput);
  REQUIRE(text.exitCode == 0);
  CHECK_THAT(text.output,
             Contains("--plugin-param org.c3de.magnet:reach=0.1  Reach, m; accepted: 0.001 <= value <= 10") &&
                 Contains("reads .tri") && Contains("writes .tri"));
  const auto json = nlohmann::json::parse(
      runC3de({"plugins", "--no-plugins", "--plugin", example("magnet"), "--plugin", example("mesh_reader"), "--json"})
          .output);
  CHECK(json.at("plugins").at(0).at("parameters").size() == 3);
  CHECK(json.at("plugins").at(0).at("parameters").at(0).at("id") == "strength");
  CHECK(json.at("plugins").at(1).at("writes") == nlohmann::json::array({"tri"}));
}

TEST_CASE("The example of a clamp lifts and turns a body of either simulator") {
  const auto folder = freshFolder("clamp");
  const auto scene = writeBoxScene(folder);
  const auto report = folder / "report.json";
  const auto bodyAfter = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"run",      scene.string(),         "--steps",  "40",
                                       "--plugin", example("clamp"),       "--report", report.string(),
                                       "--set",    "world.gravity=[0,0,0]"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = runC3de(arguments);
    INFO(run.errorOutput);
    REQUIRE(run.exitCode == 0);
    return readJson(report);
  };
  const auto upwards = [](const nlohmann::json &of) {
    return of.at("bodies").at(0).at("momentum").at(1).get<double>();
  };
  CHECK(upwards(bodyAfter({})) == 0.0);
  const auto lifted =
      bodyAfter({"--plugin-param", "org.c3de.clamp:closed=true", "--plugin-param", "org.c3de.clamp:lift=0.01"});
  CHECK(upwards(lifted) > 0.0);
  const auto turned =
      bodyAfter({"--plugin-param", "org.c3de.clamp:closed=true", "--plugin-param", "org.c3de.clamp:turn=30"});
  CHECK(turned.at("bodies").at(0).at("angular_momentum").at(1).get<double>() != 0.0);
  // One that prescribes only the mean of the held region.
  const std::string springs = (std::filesystem::path(testResourcesFolder()) / "scenes/springs.toml").string();
  const auto hashAfter = [&](const char *lift) {
    const auto run =
        runC3de({"run", springs, "--steps", "5", "--plugin", example("mass_spring"), "--plugin", example("clamp"),
                 "--plugin-param", "org.c3de.clamp:closed=true", "--plugin-param", lift, "--report", report.string()});
    INFO(run.errorOutput);
    REQUIRE(run.exitCode == 0);
    return readJson(report).at("state_hash");
  };
  CHECK(hashAfter("org.c3de.clamp:lift=0.01") != hashAfter("org.c3de.clamp:lift=0.0"));
}

TEST_CASE("A parameter of a plugin is set by --plugin-param, and what is wrong with one is said") {
  const auto folder = freshFolder("plugin-param");
  const auto scene = writeBoxScene(folder);
  const auto momentum = [&](const std::vector<std::string> &parameters) {
    const auto report = folder / "report.json";
    std::vector<std::string> arguments{"run",      scene.string(),         "--steps",  "5",
                                       "--plugin", example("magnet"),      "--report", report.string(),
                                       "--set",    "world.gravity=[0,0,0]"};
    for (const std::string &one : parameters) {
      arguments.push_back("--plugin-param");
      arguments.push_back(one);
    }
    const auto run = runC3de(arguments);
    INFO(run.errorOutput);
    REQUIRE(run.exitCode == 0);
    return readJson(report).at("bodies").at(0).at("momentum").get<std::vector<double>>();
  };
  CHECK(momentum({})[2] == 0.0);
  CHECK(momentum({"org.c3de.magnet:strength=20", "org.c3de.magnet:pole=0.5,0.1,2"})[2] > 0.0);
  CHECK(momentum({"org.c3de.magnet:strength=20", "org.c3de.magnet:pole=0.5,0.1,-2"})[2] < 0.0);

  const struct {
    std::string assignment, says;
  } all[] = {{"strength=20", "PLUGIN:ID=VALUE"},
             {"org.c3de.magnet:strength", "PLUGIN:ID=VALUE"},
             {"org.c3de.magnt:strength=20", "did you mean org.c3de.magnet?"},
             {"org.c3de.magnet:strenght=20", "did you mean strength?"},
             {"org.c3de.magnet:strength=much", "strength"},
             {"org.c3de.magnet:strength=-1", "strength"},
             {"org.c3de.magnet:pole=1,2", "pole"},
             {"org.c3de.magnet:pole=1,2,3,4", "pole"}};
  for (const auto &one : all) {
    INFO(one.assignment);
    const auto run = runC3de(
        {"run", scene.string(), "--steps", "1", "--plugin", example("magnet"), "--plugin-param", one.assignment});
    CHECK(run.exitCode == 2);
    CHECK_THAT(run.errorOutput, Contains("--plugin-param " + one.assignment) && Contains(one.says));
  }
}
