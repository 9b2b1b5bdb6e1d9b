// SPDX-License-Identifier: Apache-2.0
// Habits of command lines: help, version, quiet and verbose, standard streams, colours, lists.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "program.h"

namespace {

namespace fs = std::filesystem;

/// Runs a line of bash; the first argument of its own, $0, is the program.
[[maybe_unused]] c3de::ProcessResult runInShell(const std::string &line, std::vector<std::string> arguments = {}) {
  std::vector<std::string> all{"env", "-u",       "DISPLAY", "-u", "WAYLAND_DISPLAY", "bash",
                               "-o",  "pipefail", "-c",      line, C3DE_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const auto result = c3de::runProcess(all, 300.0);
  REQUIRE(result);
  return *result;
}

std::string readText(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Names that sources ask the environment for, as literals or in a list that is looped over.
std::set<std::string> namesAskedFor(const fs::path &folder) {
  static const std::regex kCall(R"re((?:getenv|environmentVariable|homeBased|environ\.get)\(\s*"([A-Z][A-Z0-9_]+)")re");
  static const std::regex kLoop(R"re(for \(const char \*\w+ : \{("[A-Z][A-Z0-9_]+"(?:, "[A-Z][A-Z0-9_]+")*)\}\))re");
  static const std::regex kPython(R"re(environ\.get, \(("[A-Z_]+"(?:, "[A-Z_]+")*)\))re");
  static const std::regex kName(R"re("([A-Z][A-Z0-9_]+)")re");
  std::set<std::string> names;
  for (const auto &entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".cpp" && extension != ".h" && extension != ".py") continue;
    const std::string text = readText(entry.path());
    for (std::sregex_iterator at(text.begin(), text.end(), kCall), end; at != end; ++at) names.insert((*at)[1]);
    for (const std::regex *list : {&kLoop, &kPython})
      for (std::sregex_iterator at(text.begin(), text.end(), *list), end; at != end; ++at) {
        // Lists of something else are looped over as well.
        const auto behind = static_cast<std::size_t>(at->position() + at->length());
        if (list == &kLoop && text.substr(behind, 150).find("environmentVariable(") == std::string::npos) continue;
        const std::string all = (*at)[1];
        for (std::sregex_iterator one(all.begin(), all.end(), kName); one != end; ++one) names.insert((*one)[1]);
      }
  }
  return names;
}

std::size_t linesOf(const std::string &text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("The command help prints what --help prints, and names the topics it knows") {
  CHECK(runC3de({"help"}).output == runC3de({"--help"}).output);
  for (const std::string command : {"run", "info", "materials", "help"})
    CHECK(runC3de({"help", command}).output == runC3de({command, "--help"}).output);
  const auto codes = runC3de({"help", "exit-codes"});
  CHECK(codes.exitCode == 0);
  CHECK_THAT(codes.output, Contains("124") && Contains("diverged"));
  const auto unknown = runC3de({"help", "rnu"});
  CHECK(unknown.exitCode == 2);
  CHECK_THAT(unknown.errorOutput, Contains("did you mean 'run'?") && Contains("environment"));
}

TEST_CASE("Help has groups and examples, and the examples name commands and options that exist") {
  const std::string run = runC3de({"run", "--help"}).output;
  CHECK_THAT(run, Contains("\nPicture:\n") && Contains("\nPlugins:\n") && Contains("\nExamples:\n"));
  static const std::regex kOption(R"re( (--[a-z][a-z-]+))re");
  for (const std::string command : {"run", "replay", "info", "materials", "parameters", "study"}) {
    INFO(command);
    const std::string help = runC3de({command, "--help"}).output;
    const std::size_t examples = help.find("\nExamples:\n");
    REQUIRE(examples != std::string::npos);
    std::istringstream lines(help.substr(examples));
    std::string line;
    while (std::getline(lines, line)) {
      if (line.find("c3de " + command) == std::string::npos) continue;
      line = line.substr(0, line.find("  #"));
      for (std::sregex_iterator at(line.begin(), line.end(), kOption), end; at != end; ++at) {
        INFO(line);
        CHECK_THAT(help.substr(0, examples), Contains("  " + (*at)[1].str()));
      }
    }
  }
}

TEST_CASE("The version is printed by version, --version and -V alike") {
  const std::string text = runC3de({"--version"}).output;
  CHECK_THAT(text, Contains("c3de "));
  CHECK(runC3de({"version"}).output == text);
  CHECK(runC3de({"-V"}).output == text);
  CHECK(runC3de({"version", "--json"}).output == runC3de({"--version", "--json"}).output);
}

TEST_CASE("Every environment variable that the sources read is listed by help environment") {
  const fs::path root = fs::path(testResourcesFolder()) / "..";
  std::set<std::string> names = namesAskedFor(root / "framework");
  for (const std::string &name : namesAskedFor(root / "plugins")) names.insert(name);
  // The search itself finds those of all three forms.
  for (const char *known :
       {"C3DE_HOME", "C3DE_PLUGIN_PATH", "C3DE_LIBRARY", "NO_COLOR", "PMI_SIZE", "XDG_CACHE_HOME"}) {
    INFO(known);
    CHECK(names.count(known) == 1);
  }
  const auto help = runC3de({"help", "environment"});
  CHECK(help.exitCode == 0);
  for (const std::string &name : names) {
    INFO("framework/app/src/commands/topics.cpp lists environment variables");
    CHECK_THAT(help.output, Contains(name));
  }
}

TEST_CASE("Material presets are listed with range, unit and source") {
  const auto table = runC3de({"materials"});
  CHECK(table.exitCode == 0);
  CHECK_THAT(table.output, Contains("E [kPa]") && Contains("liver"));
  const auto json = nlohmann::json::parse(runC3de({"materials", "--json"}).output);
  REQUIRE(json.size() > 10);
  CHECK(linesOf(table.output) == json.size() + 2);
  for (const auto &one : json) {
    CHECK(one.at("youngs_modulus_range_Pa").at(0) <= one.at("youngs_modulus_Pa"));
    CHECK(one.at("youngs_modulus_range_Pa").at(1) >= one.at("youngs_modulus_Pa"));
    CHECK_FALSE(one.at("source").get<std::string>().empty());
  }
  const auto liver = runC3de({"materials", "liver"});
  CHECK_THAT(liver.output, Contains("6000 Pa") && Contains("PMC6925591"));
  CHECK(nlohmann::json::parse(runC3de({"materials", "liver", "--json"}).output).at("youngs_modulus_Pa") == 6000.0);
  const auto unknown = runC3de({"materials", "livr"});
  CHECK(unknown.exitCode == 2);
  CHECK_THAT(unknown.errorOutput, Contains("did you mean 'liver'?"));
}

TEST_CASE("Parameters are listed by the keys that --set accepts") {
  const auto folder = freshFolder("parameters");
  const auto scene = writeBoxScene(folder).string();
  const auto listed = runC3de({"parameters", "--json"});
  INFO(listed.errorOutput);
  REQUIRE(listed.exitCode == 0);
  const auto json = nlohmann::json::parse(listed.output);
  std::size_t bodies = 0, tried = 0;
  for (const auto &one : json.at("parameters")) {
    const std::string key = one.at("key");
    INFO(key);
    if (one.at("scope") == "body") ++bodies;
    CHECK_FALSE(one.at("accepted").get<std::string>().empty());
    if (key != "solver.damping" && key != "body.NAME.material.youngs_modulus" && key != "contact.friction") continue;
    ++tried;
    std::string path = key;
    if (const std::size_t name = path.find("NAME"); name != std::string::npos) path.replace(name, 4, "box");
    const auto taken =
        runC3de({"run", scene, "--steps", "0", "-q", "--set", path + "=" + one.at("default").get<std::string>()});
    INFO(taken.errorOutput);
    CHECK(taken.exitCode == 0);
  }
  CHECK(tried == 3);
  CHECK(bodies > 10);
  const auto text = runC3de({"parameters"});
  CHECK_THAT(text.output,
             Contains("body.NAME.material.youngs_modulus=") && Contains(" Pa") && Contains("solver.damping="));
  CHECK(runC3de({"parameters", "--no-plugins"}).exitCode == 4);
}

TEST_CASE("Quiet prints errors only, verbose prints files, times and progress as well") {
  const auto folder = freshFolder("verbosity");
  const auto scene = writeBoxScene(folder).string();
  const auto run = [&](const std::vector<std::string> &more) {
    std::vector<std::string> all{"run", scene, "--steps", "20", "--report", (folder / "r.json").string()};
    all.insert(all.end(), more.begin(), more.end());
    return runC3de(all);
  };
  const auto usual = run({}), quiet = run({"-q"}), verbose = run({"-v"});
  CHECK_FALSE(usual.output.empty());
  CHECK(quiet.exitCode == 0);
  CHECK(quiet.output.empty());
  CHECK(quiet.errorOutput.empty());
  CHECK_THAT(verbose.errorOutput, Contains("Falling box") && Contains("bodies are built") && Contains("50 %: ") &&
                                      Contains("wrote ") && Contains("r.json"));
  CHECK(linesOf(verbose.errorOutput) > linesOf(usual.errorOutput) + 10);
  const auto both = run({"-q", "-v"});
  CHECK(both.exitCode == 2);
  CHECK_THAT(both.errorOutput, Contains("--verbose") && Contains("--quiet"));
}

#if !defined(_WIN32)
TEST_CASE("A scene is read from standard input, and a report is written to standard output") {
  const auto folder = freshFolder("streams");
  const auto scene = writeBoxScene(folder);
  const auto piped =
      runInShell("cd \"$1\" && cat box.toml | \"$0\" run - --steps 3 --report - -q | cat", {folder.string()});
  INFO(piped.errorOutput);
  REQUIRE(piped.exitCode == 0);
  const auto fromPipe = nlohmann::json::parse(piped.output);
  CHECK(fromPipe.at("steps") == 3);
  auto fromFile = runToReport(scene, {"--steps", "3"});
  CHECK(fromPipe.at("state_hash") == fromFile.at("state_hash"));

  // What people read is on the other stream.
  const auto both = runInShell("\"$0\" run \"$1\" --steps 3 --probes -", {scene.string()});
  CHECK(both.exitCode == 0);
  CHECK(both.output.starts_with("time [s],"));
  CHECK(linesOf(both.output) == 5);
  CHECK_THAT(both.errorOutput, Contains("3 steps of"));

  // What was in a file is kept where the shell appends.
  writeFile(folder / "all.csv", "before\n");
  const auto appended =
      runInShell("\"$0\" run \"$1\" --steps 1 -q --probes - >>\"$2\"", {scene.string(), (folder / "all.csv").string()});
  CHECK(appended.exitCode == 0);
  CHECK(readFile(folder / "all.csv").starts_with("before\ntime [s],"));

  const auto two = runC3de({"run", scene.string(), "--report", "-", "--probes", "-"});
  CHECK(two.exitCode == 2);
  CHECK_THAT(two.errorOutput, Contains("--report and --probes both write to standard output"));
  const auto empty = runInShell("\"$0\" run - --steps 1 </dev/null");
  CHECK(empty.exitCode == 3);
  CHECK_THAT(empty.errorOutput, Contains("standard input: is empty; accepted: a scene as TOML"));
  const auto wrong = runInShell("printf 'format = 1\\nbodies = 3\\n' | \"$0\" run - --steps 1");
  CHECK(wrong.exitCode == 3);
  CHECK_THAT(wrong.errorOutput, Contains("standard input:2: "));
}

TEST_CASE("info describes a scene of standard input as the same scene of a file") {
  const auto folder = freshFolder("info-stream");
  const auto scene = writeBoxScene(folder);
  const auto piped = runInShell("cd \"$1\" && \"$0\" info - --json <box.toml", {folder.string()});
  INFO(piped.errorOutput);
  REQUIRE(piped.exitCode == 0);
  auto fromPipe = nlohmann::json::parse(piped.output);
  CHECK(fromPipe.at("file") == "standard input");
  auto fromFile = nlohmann::json::parse(runC3de({"info", scene.string(), "--json"}).output);
  CHECK(fromPipe.at("kind") == "scene");
  CHECK(fromPipe.at("bodies").at(0).at("name") == fromFile.at("bodies").at(0).at("name"));
  CHECK(fromPipe.at("bodies").at(0).at("params") == fromFile.at("bodies").at(0).at("params"));
  CHECK(fromPipe.size() == fromFile.size());

  const auto text = runInShell("cd \"$1\" && \"$0\" info box.toml - <box.toml", {folder.string()});
  CHECK(text.exitCode == 0);
  CHECK_THAT(text.output, Contains("box.toml\n") && Contains("standard input\n"));
  const auto empty = runInShell("\"$0\" info - </dev/null");
  CHECK(empty.exitCode == 3);
  CHECK_THAT(empty.errorOutput, Contains("standard input: is empty; accepted: a scene as TOML"));
  const auto wrong = runInShell("printf 'format = 1\\nbodies = 3\\n' | \"$0\" info -");
  CHECK(wrong.exitCode == 3);
  CHECK_THAT(wrong.errorOutput, Contains("standard input:2: "));
}

TEST_CASE("Without a library of the display a scene runs, and a window or a picture is refused with its name") {
  const auto folder = freshFolder("no-display-library");
  const std::string scene = writeBoxScene(folder).string();
  if (runInShell("\"${0%/*}/c3de-workstation\" --version").exitCode != 0) C3DE_SKIP("there is no c3de-workstation");
  // The loader refuses an empty file as it refuses a missing one.
  writeFile(folder / "libX11.so.6", "");
  const std::string without = "LD_LIBRARY_PATH=\"$1\" ";
  const std::string library = (folder / "libX11.so.6").string();
  if (runInShell(without + "\"${0%/*}/c3de-workstation\" --version", {folder.string()}).exitCode != 127)
    C3DE_SKIP("c3de-workstation does not load libX11");
  const auto ran = runInShell(without + "\"$0\" run \"$2\" --steps 1 -q", {folder.string(), scene});
  INFO(ran.errorOutput);
  CHECK(ran.exitCode == 0);
  const auto picture =
      runInShell(without + "\"$0\" run \"$2\" --steps 1 -q --screenshot \"$1/a.png\"", {folder.string(), scene});
  CHECK(picture.exitCode == 6);
  CHECK_THAT(picture.errorOutput, Contains(library) && Contains("cannot be loaded"));
  CHECK_FALSE(std::filesystem::exists(folder / "a.png"));
  const auto window = runInShell("DISPLAY=:0 " + without + "\"$0\" \"$2\"", {folder.string(), scene});
  CHECK(window.exitCode == 6);
  CHECK_THAT(window.errorOutput, Contains(library));
}

TEST_CASE("Messages have colours on a terminal alone, and none with NO_COLOR") {
  if (runInShell("command -v script >/dev/null").exitCode != 0) C3DE_SKIP("the program script is not installed");
  const std::string escape = "\x1b[";
  const auto onTerminal = [&](const std::string &environment) {
    return runInShell("env " + environment + " TERM=xterm script -qec \"$0 info /nowhere.obj\" /dev/null </dev/null")
        .output;
  };
  CHECK_THAT(onTerminal("-u NO_COLOR"), Contains(escape) && Contains("nowhere.obj"));
  CHECK_THAT(onTerminal("NO_COLOR=1"), !Contains(escape) && Contains("c3de: error: "));
  CHECK_THAT(runC3de({"info", "/nowhere.obj"}).errorOutput, !Contains(escape) && Contains("c3de: error: "));
}
#endif

TEST_CASE("A screenshot named .jpg is a JPEG, and an unknown extension is refused before the run", "[gpu]") {
  const auto folder = freshFolder("jpeg");
  const auto scene = writeBoxScene(folder).string();
  const auto refused = runWithoutDisplay({"run", scene, "--until", "1e6", "--screenshot", (folder / "a.bmp").string()});
  CHECK(refused.exitCode == 2);
  CHECK_THAT(refused.errorOutput, Contains("'.bmp' cannot be written; accepted: .png, .jpg, .jpeg, .ppm"));
  const auto drawn = runWithoutDisplay(
      {"run", scene, "--steps", "1", "-q", "--size", "320x200", "--screenshot", (folder / "a.JPG").string()});
  if (drawn.exitCode == 6) C3DE_SKIP("no OpenGL here: " + drawn.errorOutput);
  REQUIRE(drawn.exitCode == 0);
  const std::string jpeg = readFile(folder / "a.JPG");
  REQUIRE(jpeg.size() > 2000);
  CHECK(jpeg.substr(0, 3) == "\xff\xd8\xff");
  CHECK(jpeg.substr(jpeg.size() - 2) == "\xff\xd9");
  // Size of the frame: marker SOF0, length, precision, height, width.
  const std::size_t frame = jpeg.find("\xff\xc0");
  REQUIRE(frame != std::string::npos);
  const auto word = [&](std::size_t at) {
    return 256 * static_cast<unsigned char>(jpeg[at]) + static_cast<unsigned char>(jpeg[at + 1]);
  };
  CHECK(word(frame + 5) == 200);
  CHECK(word(frame + 7) == 320);
}
