// SPDX-License-Identifier: Apache-2.0
#include "program.h"

TEST_CASE("The option --version names product and ABI, as text and as JSON") {
  const auto text = runC3de({"--version"});
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("c3de ") && Contains("ABI"));
  const auto json = runC3de({"--version", "--json"});
  CHECK(json.exitCode == 0);
  const auto parsed = nlohmann::json::parse(json.output);
  CHECK(parsed.at("abi").at("major") == 1);
  CHECK(parsed.at("services").size() >= 10);
}

TEST_CASE("The option --help explains every sub-command and ends well") {
  const auto help = runC3de({"--help"});
  CHECK(help.exitCode == 0);
  CHECK_THAT(help.output, Contains("run") && Contains("info") && Contains("plugins"));
  const auto run = runC3de({"run", "--help"});
  CHECK(run.exitCode == 0);
  CHECK_THAT(run.output, Contains("--until") && Contains("--report") && Contains("--set"));
}

TEST_CASE("Wrong usage ends with 2, says what is wrong on stderr and nothing on stdout") {
  const struct {
    std::vector<std::string> arguments;
    const char *contains;
  } cases[] = {
      {{"rnu"}, "did you mean 'run'?"},
      {{"--frobnicate"}, "--frobnicate"},
      {{"run"}, "SCENE"},
      {{"run", "a.toml", "--frobnicate"}, "--frobnicate"},
      {{"run", "a.toml", "--until", "1", "--steps", "3"}, "--until"},
      {{"run", "a.toml", "--until", "-1"}, "--until"},
      {{"run", "a.toml", "--steps", "many"}, "--steps"},
      {{"run", "a.toml", "--threads", "0"}, "--threads"},
      {{"run", "a.toml", "--screenshot", "a.png", "--size", "huge"}, "WIDTHxHEIGHT"},
      {{"run", "a.toml", "--size", "640x480"}, "--screenshot"},
      {{"run", "a.toml", "--export", "a.vtk"}, "accepted: .pvd"},
      {{"run", "a.toml", "--export-every", "0.1"}, "--export"},
      {{"run", "a.toml", "--export", "a.pvd", "--export-every", "-1"}, "--export-every"},
      {{"run", "a.toml", "--export-surface", "a.3ds"}, "'.3ds' cannot be written; accepted: .obj, .stl, .ply, .vtp"},
      {{"info"}, "FILE"},
      {{"info", "a.obj", "--unit", "inch"}, "--unit"},
      {{"study", "study.toml"}, "not served yet"},
      {{"--json"}, "--version"},
  };
  for (const auto &one : cases) {
    INFO(one.arguments.front() << " … " << one.arguments.back());
    const auto result = runWithoutDisplay(one.arguments);
    CHECK(result.exitCode == 2);
    CHECK(result.output.empty());
    CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains(one.contains));
  }
}

TEST_CASE("Files that cannot be opened end with 3 before a window comes") {
  const auto result = runWithoutDisplay({"nowhere/liver.obj"});
  CHECK(result.exitCode == 3);
  CHECK_THAT(result.errorOutput, Contains("c3de: error: nowhere/liver.obj: no such file"));
}

#if !defined(_WIN32)
TEST_CASE("Without a display the workstation says what works without one and ends with 6") {
  const auto folder = freshFolder("no-display");
  const auto mesh = writeFile(folder / "box.obj", boxObj());
  const auto result = runWithoutDisplay({mesh.string()});
  CHECK(result.exitCode == 6);
  CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains("no display") && Contains("c3de run"));
}
#endif
