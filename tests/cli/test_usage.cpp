// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

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

TEST_CASE("The texts from which ./run answers before a build are those of --help") {
  const std::filesystem::path folder = std::filesystem::path(testResourcesFolder()) / ".." / "tools" / "help";
  std::size_t count = 0;
  for (const auto &file : std::filesystem::directory_iterator(folder)) {
    const std::string command = file.path().stem().string();
    INFO("tools/update-help.sh writes " << file.path().string());
    const auto help = command == "c3de" ? runC3de({"--help"}) : runC3de({command, "--help"});
    CHECK(help.exitCode == 0);
    CHECK(help.output == readFile(file.path()));
    ++count;
    if (command != "c3de") CHECK_THAT(readFile(folder / "c3de.txt"), Contains("\n  " + command + " "));
  }
  const std::string all = readFile(folder / "c3de.txt");
  const std::size_t commands = all.find("Subcommands:\n");
  REQUIRE(commands != std::string::npos);
  CHECK(std::count(all.begin() + static_cast<std::ptrdiff_t>(commands), all.end(), '\n') >=
        static_cast<std::ptrdiff_t>(count));
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
      {{"run", "a.toml", "--until", "nan"}, "--until: 'nan' is not accepted; accepted: a number from 0"},
      {{"run", "a.toml", "--until", "inf"}, "--until: 'inf' is not accepted"},
      {{"run", "a.toml", "--until", "0x10"}, "--until: '0x10' is not accepted"},
      {{"run", "a.toml", "--until", "1e400"}, "--until: '1e400' is not accepted"},
      {{"run", "a.toml", "--until", "1,5"}, "with a decimal point"},
      {{"run", "a.toml", "--until", "1s"}, "--until: '1s' is not accepted"},
      {{"run", "a.toml", "--until", ""}, "--until: '' is not accepted"},
      {{"run", "a.toml", "--time-limit", "nan"}, "--time-limit: 'nan' is not accepted"},
      {{"run", "a.toml", "--time-limit", "-1"}, "--time-limit: '-1' is not accepted"},
      {{"run", "a.toml", "--export", "a.pvd", "--export-every", "nan"}, "--export-every: 'nan' is not accepted"},
      {{"run", "a.toml", "--steps", "0x10"}, "--steps: '0x10' is not accepted; accepted: a whole number from 0"},
      {{"run", "a.toml", "--steps", "1.5"}, "--steps: '1.5' is not accepted"},
      {{"run", "a.toml", "--steps", "99999999999999999999"}, "--steps: '99999999999999999999' is not accepted"},
      {{"run", "a.toml", "--seed", "9223372036854775808"}, "--seed: '9223372036854775808' is not accepted"},
      {{"run", "a.toml", "--probes-every", "1e2"}, "--probes-every: '1e2' is not accepted"},
      {{"run", "a.toml", "--screenshot", "a.png", "--size", "640x480x"}, "WIDTHxHEIGHT"},
      {{"run", "a.toml", "--screenshot", "a.png", "--size", " 640x 480"}, "WIDTHxHEIGHT"},
      {{"run", "a.toml", "--screenshot", "a.png", "--size", "nanxnan"}, "WIDTHxHEIGHT"},
      {{"run", "a.toml", "--camera", "30,20"}, "--camera is for --screenshot"},
      {{"run", "a.toml", "--up", "z"}, "--up is for --screenshot"},
      {{"run", "a.toml", "--screenshot", "a.png", "--up", "x"}, "--up: x not in {y,z}"},
      {{"run", "a.toml", "--screenshot", "a.png", "--camera", "30"}, "AZIMUTH,ELEVATION"},
      {{"run", "a.toml", "--screenshot", "a.png", "--camera", "nan,0"}, "AZIMUTH,ELEVATION"},
      {{"run", "a.toml", "--screenshot", "a.png", "--camera", "0,91"}, "-90 to 90"},
      {{"run", "a.toml", "--screenshot", "a.png", "--camera", "0,0", "--view", "axial"}, "is a slice; accepted: 3d"},
      {{"run", "a.toml", "--untill", "1"}, "'--untill' is not accepted here, did you mean --until?"},
      {{"run", "a.toml", "--report", ""}, "--report: the name is empty"},
      {{"run", "a.toml", "--report", "--quiet"}, "--report: '--quiet' is an option"},
      {{"info"}, "FILE"},
      {{"info", "a.obj", "--unit", "inch"}, "--unit"},
      {{"study"}, "STUDY"},
      {{"study", "study.toml"}, "--out"},
      {{"study", "study.toml", "--out", ""}, "--out: the name is empty"},
      {{"--json"}, "--version"},
  };
  for (const auto &one : cases) {
    INFO(one.arguments.front() << " … " << one.arguments.back());
    const auto result = runWithoutDisplay(one.arguments);
    CHECK(result.exitCode == 2);
    CHECK(result.output.empty());
    CHECK_THAT(result.errorOutput, Contains("c3de: error: ") && Contains(one.contains));
    // One line reports it; the help is printed only on request.
    CHECK(std::count(result.errorOutput.begin(), result.errorOutput.end(), '\n') == 1);
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
