// SPDX-License-Identifier: Apache-2.0
#include "program.h"

#include <fstream>
#include <sstream>

#include "support/environment.h"

namespace {

constexpr double kPatience_s = 300.0;

c3de::ProcessResult runProgram(const std::vector<std::string> &command) {
  // Not the files of the user who runs the tests.
  const std::string home = c3de::environmentVariable("C3DE_HOME");
  const ScopedEnvironment user("C3DE_HOME", home.empty() ? testOutputRoot() + std::string("/cli/user") : home);
  auto result = c3de::runProcess(command, kPatience_s);
  if (!result) FAIL(result.error().message);
  INFO(result->errorOutput);
  CHECK_FALSE(result->timedOut);
#if defined(_WIN32)
  // Lines of text end as on every other system.
  std::erase(result->output, '\r');
  std::erase(result->errorOutput, '\r');
#endif
  return *result;
}

}  // namespace

c3de::ProcessResult runC3de(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), C3DE_PROGRAM);
  return runProgram(arguments);
}

c3de::ProcessResult runWithoutDisplay(std::vector<std::string> arguments) {
#if !defined(_WIN32)
  arguments.insert(arguments.begin(), {"env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", C3DE_PROGRAM});
  return runProgram(arguments);
#else
  return runC3de(arguments);
#endif
}

nlohmann::json runToReport(const std::filesystem::path &scene, std::vector<std::string> options) {
  // Beside no scene: those of the program are not written to. Tests run in several processes.
  const auto folder = std::filesystem::path(testOutputRoot()) / "cli";
  std::filesystem::create_directories(folder);
  const auto report = folder / ("report-" + std::to_string(c3de::processId()) + ".json");
  options.insert(options.begin(), {"run", scene.string(), "--report", report.string(), "-q"});
  const auto ran = runC3de(options);
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  return readJson(report);
}

std::filesystem::path freshFolder(const std::string &name) {
  const std::filesystem::path folder = std::filesystem::path(testOutputRoot()) / "cli" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

std::filesystem::path writeFile(const std::filesystem::path &file, const std::string &text) {
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string readFile(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

nlohmann::json readJson(const std::filesystem::path &file) {
  const auto json = nlohmann::json::parse(readFile(file), nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

std::string boxObj() {
  return "v 0 0 0\nv 1 0 0\nv 1 0.2 0\nv 0 0.2 0\nv 0 0 0.2\nv 1 0 0.2\nv 1 0.2 0.2\nv 0 0.2 0.2\n"
         "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

std::filesystem::path writeBoxScene(const std::filesystem::path &folder, const std::string &more) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "box.toml", R"(format = 1
title = "Falling box"

[world]
gravity = [0.0, -9.81, 0.0]

[[body]]
name = "box"
mesh = "box.obj"
mesh_unit = "m"
material = { law = "stvk", youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1000.0 }
sampling = { spacing = 0.06 }

[[probe]]
name = "tip"
body = "box"
at = [0.9, 0.1, 0.1]
)" + more);
}
