// SPDX-License-Identifier: Apache-2.0
// The error of a run (--verify), and the composition of its steps (info).
#include <algorithm>

#include "program.h"
#include "support/folders.h"

namespace {

std::filesystem::path beamScene(const std::filesystem::path &folder, const std::string &more = "") {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(
      folder / "beam.toml",
      "format = 1\ntitle = \"Beam\"\n[solver]\nintegrator = \"quasistatic\"\n[[body]]\nname = \"beam\"\nmesh = "
      "\"box.obj\"\nmesh_unit = \"m\"\nmaterial = { youngs_modulus = 1e4, poisson_ratio = 0.3 }\nsampling = { "
      "spacing = 0.0667 }\n[[fix]]\nname = \"wall\"\nbody = \"beam\"\nregion = { box = { min = [-0.01, -1, "
      "-1], max = [0.0001, 1, 1] } }\n[[load]]\nname = \"weight\"\nbody = \"beam\"\nregion = { box = { min = "
      "[0.9999, -1, -1], max = [1.1, 1, 1] } }\nforce = [0, 0, -0.04]\n" +
          more);
}

std::vector<std::string> running(const nlohmann::json &json, std::size_t body = 0) {
  std::vector<std::string> out;
  for (const auto &stage : json.at("composition").at(body).at("stages"))
    if (stage.at("runs").get<bool>()) out.push_back(stage.at("name").get<std::string>());
  return out;
}

}  // namespace

TEST_CASE("run --verify: the error of the end state is in the report and is said", "[verify]") {
  const auto folder = freshFolder("verify");
  const auto scene = beamScene(folder);
  const auto plain = runC3de({"run", scene.string(), "-q", "--report", (folder / "plain.json").string()});
  REQUIRE(plain.exitCode == 0);
  const auto ran = runC3de({"run", scene.string(), "--verify", "--report", (folder / "report.json").string()});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  CHECK_THAT(ran.output, Contains("beam: Displacement: ± ") && Contains("(verified with "));
  const auto report = readJson(folder / "report.json"), before = readJson(folder / "plain.json");
  const auto &verified = report["bodies"][0]["verification"];
  CHECK(verified["error_95_m"].get<double>() > 0.0);
  CHECK(verified["error_max_m"].get<double>() >= verified["error_95_m"].get<double>());
  CHECK(verified["error_95_percent"].get<double>() < 5.0);
  CHECK(verified["shadow_phyxels"].get<int>() > 4 * verified["phyxels"].get<int>());
  CHECK(verified["reactions"][0]["shadow_force_N"][2].get<double>() == Approx(0.04).epsilon(1e-3));
  // The run itself is unchanged by it.
  CHECK(report["state_hash"] == before["state_hash"]);
  CHECK_FALSE(before["bodies"][0].contains("verification"));
}

TEST_CASE("run --verify: a simulator that cannot is refused before the first step", "[verify]") {
  const auto folder = freshFolder("verify_refused");
  const std::string plugin = testExampleFolder() + std::string("/mass_spring") + c3de::pluginExtension();
  const auto scene = writeBoxScene(folder, "[simulator]\nclass = \"org.c3de.mass_spring.Simulator/0\"\n");
  const auto ran = runC3de({"run", scene.string(), "--plugin", plugin, "--verify", "--steps", "1"});
  CHECK(ran.exitCode != 0);
  CHECK_THAT(ran.errorOutput, Contains("does not verify"));
}

TEST_CASE("run --verify: a body that cannot be verified says why", "[verify]") {
  const auto folder = freshFolder("verify_rigid");
  writeFile(folder / "box.obj", boxObj());
  const auto scene = writeFile(folder / "scene.toml",
                               "format = 1\n[[body]]\nname = \"bone\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nrigid = "
                               "true\nsampling = { count = 100 }\n");
  const auto ran = runC3de({"run", scene.string(), "--verify", "--steps", "1"});
  INFO(ran.errorOutput);
  CHECK(ran.exitCode == 0);
  CHECK_THAT(ran.output, Contains("bone: not verified: it is rigid"));
}

TEST_CASE("info: the stages of a step, and an obstacle adds its own", "[verify]") {
  const auto folder = freshFolder("verify_info");
  const auto scene = beamScene(folder);
  const auto text = runC3de({"info", scene.string()});
  REQUIRE(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("step of \"beam\""));
  CHECK_THAT(text.output, Contains("  + supports: 1 fix"));
  CHECK_THAT(text.output, Contains("  - contact: no obstacle, no walls"));
  const auto plain = nlohmann::json::parse(runC3de({"info", scene.string(), "--json"}).output);
  const auto more =
      beamScene(folder,
                "[[obstacle]]\nname = \"block\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nposition = [0, 0, "
                "-2]\n");
  const auto with = nlohmann::json::parse(runC3de({"info", more.string(), "--json"}).output);
  const auto before = running(plain), after = running(with);
  CHECK(std::find(before.begin(), before.end(), "contact") == before.end());
  CHECK(after.size() == before.size() + 1);
  CHECK(std::find(after.begin(), after.end(), "contact") != after.end());
}
