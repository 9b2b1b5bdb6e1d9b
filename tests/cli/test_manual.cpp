// SPDX-License-Identifier: Apache-2.0
// Man pages and completion: that they have what --help has.
#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "program.h"

#if !defined(_WIN32)
namespace {

namespace fs = std::filesystem;

/// Names in the first column of a help text: options if they begin with -, else commands.
std::vector<std::string> namesOf(const std::string &help, bool areOptions) {
  const std::size_t commands = help.find("\nSubcommands:\n");
  std::istringstream lines(areOptions                      ? help.substr(0, commands)
                           : commands == std::string::npos ? ""
                                                           : help.substr(commands));
  static const std::regex kOption(R"re(^  (-[^ ]+))re"), kCommand(R"re(^  ([a-z][a-z-]*) )re");
  std::vector<std::string> names;
  std::string line;
  std::smatch found;
  while (std::getline(lines, line)) {
    if (!std::regex_search(line, found, areOptions ? kOption : kCommand)) continue;
    std::istringstream all(found[1]);
    for (std::string name; std::getline(all, name, ',');) names.push_back(name);
  }
  return names;
}

std::vector<std::string> commands() {
  const auto names = namesOf(runC3de({"--help"}).output, false);
  REQUIRE(names.size() > 8);
  return names;
}

/// Folder with man1/*.1, c3de.bash and _c3de.
fs::path manual() {
  const fs::path folder = freshFolder("manual-" + std::to_string(c3de::processId()));
  const auto written = runC3de({"write-manual", folder.string(), "--date", "2026-01-31"});
  INFO(written.errorOutput);
  REQUIRE(written.exitCode == 0);
  return folder;
}

/// What bash offers for a line whose last word is being typed, in the folder.
std::set<std::string> offered(const fs::path &script, const fs::path &folder, const std::vector<std::string> &words) {
  const std::string line =
      "cd \"$1\" && . \"$0\" && complete -p c3de >/dev/null && shift && COMP_WORDS=(\"$@\") COMP_CWORD=$(($# - 1)) && "
      "_c3de && "
      "printf '%s\\n' \"${COMPREPLY[@]}\"";
  std::vector<std::string> all{"bash", "-c", line, script.string(), folder.string()};
  all.insert(all.end(), words.begin(), words.end());
  const auto result = c3de::runProcess(all, 60.0);
  REQUIRE(result);
  INFO(result->errorOutput);
  CHECK(result->exitCode == 0);
  CHECK(result->errorOutput.empty());
  std::set<std::string> lines;
  std::istringstream in(result->output);
  for (std::string one; std::getline(in, one);)
    if (!one.empty()) lines.insert(one);
  return lines;
}

/// As a man page spells it.
std::string inRoff(const std::string &text) { return std::regex_replace(text, std::regex("-"), "\\-"); }

}  // namespace

TEST_CASE("Every command has a man page, which has every option of its help") {
  const fs::path folder = manual();
  const std::string rootPage = readFile(folder / "man1" / "c3de.1");
  for (const std::string &name : namesOf(runC3de({"--help"}).output, true)) {
    INFO(name);
    CHECK_THAT(rootPage, Contains("\\fB" + inRoff(name) + "\\fR"));
  }
  CHECK_THAT(rootPage, Contains("C3DE_PLUGIN_PATH") && Contains(".SH \"EXIT STATUS\"") && Contains("124"));
  for (const std::string &command : commands()) {
    INFO(command);
    CHECK_THAT(rootPage, Contains("\\fB" + inRoff(command) + "\\fR\n"));
    const std::string page = readFile(folder / "man1" / ("c3de-" + command + ".1"));
    REQUIRE_FALSE(page.empty());
    const auto options = namesOf(runC3de({command, "--help"}).output, true);
    CHECK(options.size() >= 2);
    for (const std::string &name : options) {
      INFO(name);
      CHECK_THAT(page, Contains("\\fB" + inRoff(name) + "\\fR"));
    }
  }
  // What --help hides is nowhere.
  CHECK_THAT(rootPage, !Contains("write\\-manual"));
  CHECK_THAT(readFile(folder / "man1" / "c3de-run.1"), !Contains("end\\-with\\-parent") && Contains(".SH EXAMPLES"));
}

TEST_CASE("Man pages are formatted without a warning") {
  const fs::path folder = manual();
  if (c3de::runProcess({"bash", "-c", "command -v groff >/dev/null"}, 60.0)->exitCode != 0)
    C3DE_SKIP("groff is not installed");
  for (const auto &page : fs::directory_iterator(folder / "man1")) {
    if (readFile(page.path()).starts_with(".so ")) continue;
    INFO(page.path().string());
    const auto result = c3de::runProcess(
        {"groff", "-man", "-K", "utf8", "-T", "utf8", "-P", "-c", "-P", "-b", "-ww", page.path().string()}, 60.0);
    REQUIRE(result);
    CHECK(result->exitCode == 0);
    CHECK(result->errorOutput.empty());
    CHECK(result->output.size() > 500);
  }
}

TEST_CASE("The shell completes commands, options and the values of options") {
  const fs::path folder = manual();
  const fs::path script = folder / "c3de.bash";
  CHECK(runC3de({"completion", "bash"}).output == readFile(script));
  CHECK(runC3de({"completion", "zsh"}).output == readFile(folder / "_c3de"));
  const fs::path place = freshFolder("completed");
  for (const char *name : {"scene.toml", "day.c3dr", "two words.c3dr"}) writeFile(place / name, "");
  fs::create_directories(place / "results");

  auto first = offered(script, place, {"c3de", ""});
  for (const std::string &command : commands()) CHECK(first.count(command) == 1);
  CHECK(first.count("scene.toml") == 1);
  CHECK(offered(script, place, {"c3de", "re"}) == std::set<std::string>{"replay", "results"});
  CHECK(offered(script, place, {"c3de", "write-m"}).empty());

  // Every option of every command is offered.
  for (const std::string &command : commands()) {
    INFO(command);
    const auto options = offered(script, place, {"c3de", command, "-"});
    const auto named = namesOf(runC3de({command, "--help"}).output, true);
    CHECK(std::set<std::string>(named.begin(), named.end()) == options);
  }
  CHECK(offered(script, place, {"c3de", "run", "scene.toml", "--export-d"}) ==
        std::set<std::string>{"--export-displacement"});

  CHECK(offered(script, place, {"c3de", "run", "--unit", ""}) == std::set<std::string>{"m", "mm", "cm"});
  CHECK(offered(script, place, {"c3de", "run", "--unit", "=", "c"}) == std::set<std::string>{"cm"});
  CHECK(offered(script, place, {"c3de", "run", "--unit", "="}) == std::set<std::string>{"m", "mm", "cm"});
  CHECK(offered(script, place, {"c3de", "run", "--view", "a"}) == std::set<std::string>{"axial"});
  CHECK(offered(script, place, {"c3de", "help", "env"}) == std::set<std::string>{"environment"});
  CHECK(offered(script, place, {"c3de", "replay", ""}) ==
        std::set<std::string>{"day.c3dr", "two words.c3dr", "results"});
  CHECK(offered(script, place, {"c3de", "replay", "two"}) == std::set<std::string>{"two words.c3dr"});
  CHECK(offered(script, place, {"c3de", "study", "s.toml", "--out", ""}) == std::set<std::string>{"results"});
  // A number has nothing to complete.
  CHECK(offered(script, place, {"c3de", "run", "--until", ""}).empty());
}

TEST_CASE("The completion for zsh is valid and names every command") {
  const fs::path folder = manual();
  const std::string script = readFile(folder / "_c3de");
  for (const std::string &command : commands()) CHECK_THAT(script, Contains("'" + command + ":"));
  if (c3de::runProcess({"bash", "-c", "command -v zsh >/dev/null"}, 60.0)->exitCode != 0)
    C3DE_SKIP("zsh is not installed; its syntax is not checked");
  const auto checked = c3de::runProcess({"zsh", "-n", (folder / "_c3de").string()}, 60.0);
  REQUIRE(checked);
  CHECK(checked->exitCode == 0);
  CHECK(checked->errorOutput.empty());
}
#endif
