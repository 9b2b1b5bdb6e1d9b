// SPDX-License-Identifier: Apache-2.0
// Reports of shipped scenes against resources/schemas/report.schema.json.
#include <filesystem>
#include <string>
#include <vector>

#include "json_schema.h"
#include "program.h"

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const json &schema() {
  static const json kSchema = readJson(fs::path(testResourcesFolder()) / "schemas" / "report.schema.json");
  return kSchema;
}

/// @param options  of `c3de run`
json reportOf(const std::string &scene, std::vector<std::string> options) {
  const fs::path report = freshFolder("report_schema_" + scene) / "report.json";
  std::vector<std::string> arguments{"run", (fs::path(testResourcesFolder()) / "scenes" / (scene + ".toml")).string(),
                                     "-q", "--report", report.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const auto run = runC3de(arguments);
  INFO(run.errorOutput);
  REQUIRE(run.exitCode == 0);
  return readJson(report);
}

void checkFits(const json &report) {
  for (const std::string &departure : departuresFrom(schema(), report)) FAIL_CHECK(departure);
}

void namesOf(const json &part, std::vector<std::string> &names) {
  if (!part.is_structured()) return;
  if (part.is_object() && part.contains("properties") && part["properties"].is_object())
    for (const auto &[key, value] : part["properties"].items()) names.push_back(key);
  for (const auto &[key, value] : part.items()) namesOf(value, names);
}

}  // namespace

TEST_CASE("A report of the shipped scan fits the schema: supports, surroundings, probes, image") {
  const json report = reportOf("living_scan", {"--steps", "3", "--seed", "7"});
  checkFits(report);
  CHECK(report["attachments"].size() == 1);
  CHECK(report["reactions"].size() == 1);
}

TEST_CASE("A report of a body of many tissues fits the schema") {
  const json report = reportOf("whole_scan", {"--steps", "2", "--set", "body.abdomen.sampling.count=600"});
  checkFits(report);
  CHECK(report["bodies"][0]["tissues"].size() > 10);
}

TEST_CASE("A report of a verified quasi-static solution fits the schema") {
  const json report = reportOf("cantilever", {"--verify"});
  checkFits(report);
  CHECK(report["bodies"][0]["verification"].contains("error_95_m"));
}

TEST_CASE("A report of contact, of an accuracy target and of a cloud fits the schema") {
  checkFits(reportOf("first_light", {"--until", "0.4", "--set", "body.organ.sampling.count=300"}));
  checkFits(reportOf("first_light", {"--steps", "2", "--set", "accuracy.error_percent=10", "--set",
                                     "body.organ.sampling.count=auto"}));
  checkFits(reportOf("first_light", {"--steps", "2", "--set", "body.organ.sampling.evaluation=phyxels"}));
}

TEST_CASE("A report of jaws, landmarks and a run out of time fits the schema") {
  const fs::path folder = freshFolder("report_schema_box");
  const fs::path scene = writeBoxScene(folder, R"(
[[grasp]]
name = "jaws"
at = [0.5, 0.2, 0.1]
axis = [1, 0, 0]
jaw_mm = 200
opening_mm = 400
[[landmark]]
name = "a"
at = [0.1, 0.1, 0.1]
target = [0.1, 0.1, 0.1]
[[landmark]]
name = "b"
at = [0.9, 0.1, 0.1]
[[distance]]
between = ["a", "b"]
)");
  checkFits(runToReport(scene, {"--steps", "5"}));
  const fs::path report = folder / "late.json";
  const auto run =
      runC3de({"run", scene.string(), "-q", "--until", "1e6", "--time-limit", "2", "--report", report.string()});
  CHECK(run.exitCode == 124);
  const json late = readJson(report);
  CHECK(late["outcome"] == "time_limit");
  checkFits(late);
}

TEST_CASE("A report that departs from the schema is refused") {
  const json report = reportOf("cantilever", {});
  REQUIRE(departuresFrom(schema(), report).empty());
  const auto refused = [&](const char *pointer, const json &value, const char *says) {
    json wrong = report;
    wrong[json::json_pointer(pointer)] = value;
    const auto found = departuresFrom(schema(), wrong);
    INFO(pointer);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found.front(), Contains(pointer) || Contains("is not in the schema"));
    CHECK_THAT(found.front(), Contains(says));
  };
  refused("/steps", -1, "minimum");
  refused("/outcome", "good", "is not in");
  refused("/bodies/0/mass_kg", "heavy", "type");
  refused("/bodies/0/momentum", json::array({0, 0}), "items");
  refused("/state_hash", "xyz", "does not match");
  refused("/bodies/0/colour", "red", "is not in the schema");
  json without = report;
  without["bodies"][0].erase("phyxels");
  REQUIRE(departuresFrom(schema(), without).size() == 1);
}

TEST_CASE("The guide describes every key of the schema of reports") {
  const std::string guide = readFile(fs::path(testResourcesFolder()).parent_path() / "docs" / "user" / "headless.md");
  std::vector<std::string> names;
  namesOf(schema(), names);
  REQUIRE(names.size() > 150);
  for (const std::string &name : names) {
    INFO(name);
    CHECK((guide.find("`" + name + "`") != std::string::npos || guide.find("`" + name + "[]`") != std::string::npos));
  }
}
