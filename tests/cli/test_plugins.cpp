// SPDX-License-Identifier: Apache-2.0
#include "program.h"

TEST_CASE("plugins lists what lies beside the program, with its classes") {
  const auto json = runC3de({"plugins", "--json"});
  CHECK(json.exitCode == 0);
  const auto parsed = nlohmann::json::parse(json.output);
  bool found = false;
  for (const auto &one : parsed.at("classes"))
    found = found || one.at("interfaces").dump().find("iface.simulator") != std::string::npos;
  CHECK(found);
  CHECK_THAT(runC3de({"plugins"}).output, Contains("loaded") && Contains("class "));
}

TEST_CASE("plugins says why a file is refused, only a named one is an error") {
  const auto folder = freshFolder("plugins");
  const auto broken = writeFile(folder / (std::string("broken") + c3de::pluginExtension()), "this is no library");
  const auto inFolder = runC3de({"plugins", "--json", "--plugin-path", folder.string()});
  CHECK(inFolder.exitCode == 0);
  bool refused = false;
  const auto listed = nlohmann::json::parse(inFolder.output);
  for (const auto &plugin : listed.at("plugins"))
    refused = refused || (plugin.at("state") == "refused" && !plugin.at("reason").get<std::string>().empty());
  CHECK(refused);

  const auto named = runC3de({"plugins", "--plugin", broken.string()});
  CHECK(named.exitCode == 4);
  CHECK_THAT(named.errorOutput, Contains("c3de: error: ") && Contains("broken"));
  CHECK_THAT(named.output, Contains("refused") && Contains("loaded"));
}

TEST_CASE("A plugin or folder that is not there ends with 4") {
  const auto folder = freshFolder("plugins-absent");
  const auto scene = writeBoxScene(folder);
  const auto plugin = runC3de({"run", scene.string(), "--plugin", (folder / "absent.so").string()});
  CHECK(plugin.exitCode == 4);
  CHECK_THAT(plugin.errorOutput, Contains("absent.so"));
  const auto path = runC3de({"run", scene.string(), "--plugin-path", (folder / "absent").string()});
  CHECK(path.exitCode == 4);
  CHECK_THAT(path.errorOutput, Contains("absent") && Contains("no such folder"));
  CHECK(runC3de({"plugins", "--plugin-path", (folder / "absent").string()}).exitCode == 4);
}

TEST_CASE("Without plugins a run ends with 4 and says what is missing") {
  const auto folder = freshFolder("no-plugins");
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--no-plugins"});
  CHECK(result.exitCode == 4);
  CHECK_THAT(result.errorOutput,
             Contains("c3de: error: ") && Contains("no plugin that simulates is loaded") && Contains("`c3de plugins`"));
  const auto list = runC3de({"plugins", "--no-plugins", "--json"});
  CHECK(list.exitCode == 0);
  CHECK(nlohmann::json::parse(list.output).at("plugins").empty());
}

TEST_CASE("Without the search for plugins those that are named are loaded, and no others") {
  const auto folder = freshFolder("named-plugins");
  const std::string named =
      (std::filesystem::path(testPluginFolder()) / (std::string("pointbased") + c3de::pluginExtension())).string();
  const auto result =
      runC3de({"run", writeBoxScene(folder).string(), "--no-plugins", "--plugin", named, "--steps", "2"});
  CHECK(result.exitCode == 0);
  const auto list = runC3de({"plugins", "--no-plugins", "--plugin", named, "--json"});
  CHECK(list.exitCode == 0);
  const auto found = nlohmann::json::parse(list.output);
  CHECK(found.at("folders").empty());
  REQUIRE(found.at("plugins").size() == 1);
  CHECK(found.at("plugins").at(0).at("id") == "c3de.pointbased");
}
