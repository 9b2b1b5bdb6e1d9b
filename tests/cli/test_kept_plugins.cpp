// SPDX-License-Identifier: Apache-2.0
// Plugins built when the interfaces were frozen behave in the current program like current ones. Source and build
// command of each: tests/conformance/kept/README.md.
#include "program.h"

#if defined(__linux__) && defined(__x86_64__)

namespace {

using Json = nlohmann::json;

std::filesystem::path kept(const char *name) {
  return std::filesystem::path(C3DE_KEPT_PLUGINS) / "linux-x86_64" / name;
}
std::string today(const char *name) {
  return (std::filesystem::path(testExampleFolder()) / (std::string(name) + c3de::pluginExtension())).string();
}

Json reportOf(const std::filesystem::path &folder, std::vector<std::string> arguments) {
  const auto report = folder / "report.json";
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"--report", report.string(), "-q"});
  const auto run = runC3de(arguments);
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  return readJson(report);
}

}  // namespace

TEST_CASE("a magnet of the first frozen interfaces pulls an organ as today's does", "[kept]") {
  const auto folder = freshFolder("kept_magnet");
  const std::string scene = (std::filesystem::path(testResourcesFolder()) / "scenes/first_light.toml").string();
  const auto hash = [&](const std::string &plugin) {
    return reportOf(folder,
                    {scene, "--steps", "60", "--plugin", plugin, "--plugin-param", "org.c3de.magnet:strength=20"})
        .at("state_hash");
  };
  const auto then = hash(kept("magnet_of_1.so").string());
  CHECK(then == hash(today("magnet")));
  CHECK(then != reportOf(folder, {scene, "--steps", "60"}).at("state_hash"));
}

TEST_CASE("a simulator of the first frozen interfaces is chosen by a scene and runs it", "[kept]") {
  const auto folder = freshFolder("kept_simulator");
  const auto scene = writeFile(
      folder / "scene.toml",
      "format = 1\n[simulator]\nclass = \"org.example.test_pendulum.Simulator/0\"\n[world]\ngravity = [0, -2, 0]\n"
      "[[body]]\nname = \"box\"\nmesh = \"" +
          (std::filesystem::path(testResourcesFolder()) / "meshes" / "organ.obj").generic_string() +
          "\"\nmesh_unit = \"mm\"\n");
  const Json report =
      reportOf(folder, {scene.string(), "--until", "1", "--plugin", kept("simulator_of_1.so").string()});
  CHECK(report.at("simulator").at("class") == "org.example.test_pendulum.Simulator/0");
  const double time_s = report.at("time_s");
  CHECK(time_s >= 0.999);
}

TEST_CASE("a reader of phyxels of the first frozen interfaces reads what today's does", "[kept]") {
  const auto folder = freshFolder("kept_phyxels");
  const auto scene = writeBoxScene(folder);
  const auto said = [&](const std::string &plugin) {
    const auto run = runC3de({"run", scene.string(), "--steps", "1", "--plugin", plugin});
    CHECK(run.exitCode == 0);
    const auto at = run.errorOutput.find("box: ");
    return at == std::string::npos ? std::string() : run.errorOutput.substr(at, run.errorOutput.find('\n', at) - at);
  };
  const std::string then = said(kept("phyxels_of_1.so").string());
  CHECK_THAT(then, Contains(" phyxels, ") && Contains("largest Green strain 0.0"));
  CHECK(then == said((std::filesystem::path(C3DE_TEST_PLUGINS) / "phyxels.so").string()));
}

TEST_CASE("a material law of the first frozen interfaces acts as today's does", "[kept]") {
  const auto folder = freshFolder("kept_material_law");
  const auto scene = writeBoxScene(folder);
  const auto hash = [&](const std::string &plugin) {
    return reportOf(folder, {scene.string(), "--steps", "20", "--plugin", plugin, "--set",
                             "body.box.material.law=org.c3de.neo_hookean/0"})
        .at("state_hash");
  };
  CHECK(hash(kept("material_law_of_1.so").string()) == hash(today("material_law")));
}

#endif
