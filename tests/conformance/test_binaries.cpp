// SPDX-License-Identifier: Apache-2.0
// The symbols that a plugin file exports to the dynamic loader.
#include <sstream>

#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;

namespace {

/// Lines of nm; none when the tool is missing.
std::vector<std::string> symbolsOf(const std::vector<std::string> &options, const std::string &file) {
  std::vector<std::string> arguments{"nm"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  arguments.push_back(file);
  const auto result = runProcess(arguments, 20.0);
  std::vector<std::string> lines;
  if (!result || result->exitCode != 0) return lines;
  std::istringstream text(result->output);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> pluginFiles() {
  std::vector<std::string> files;
  std::istringstream list(C3DE_BUILT_PLUGINS);
  for (std::string file; std::getline(list, file, '|');)
    if (!file.empty()) files.push_back(file);
  return files;
}

bool hasNm() {
  const auto result = runProcess({"nm", "--version"}, 20.0);
  return result && result->exitCode == 0;
}

}  // namespace

TEST_CASE("a plugin exports exactly one symbol, and none that keeps it in memory") {
  if (!hasNm()) C3DE_SKIP("nm is not installed");
  REQUIRE_FALSE(pluginFiles().empty());
  for (const std::string &file : pluginFiles()) {
    INFO(file);
    std::vector<std::string> exported;
    for (const std::string &line : symbolsOf({"-D", "--defined-only"}, file))
      exported.push_back(line.substr(line.rfind(' ') + 1));
    CHECK(exported == std::vector<std::string>{"c3de_plugin_query"});
    for (const std::string &line : symbolsOf({}, file)) {
      INFO(line);
      CHECK(line.find(" u ") == std::string::npos);  // STB_GNU_UNIQUE
    }
  }
}
