// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/plain_words.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "c3de/registry/panel_registry.h"
#include "support/catch.h"

using namespace c3de;
using registry::plainWords;

namespace {

std::string contents(const std::filesystem::path &file) {
  std::ifstream in(file);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

void declare(registry::ParameterRegistry &parameters, const std::string &id, const std::string &label) {
  registry::ParameterSet set;
  set.owner = "test";
  ParameterDecl decl;
  decl.id = id;
  decl.label = label;
  set.decls.push_back(decl);
  (void)parameters.declare(std::move(set));
}

registry::ParameterRegistry few() {
  registry::ParameterRegistry parameters;
  declare(parameters, "solver.step_budget", "Time for a step");
  declare(parameters, "solver.dt", "Step");
  declare(parameters, "contact.self", "Contact with itself");
  declare(parameters, "rigid", "Rigid");
  return parameters;
}

std::filesystem::path sources() { return C3DE_TEST_SOURCES; }

/// All declarations of the point-based plugin, from its source.
registry::ParameterRegistry ofThePlugin() {
  registry::ParameterRegistry parameters;
  const auto addFrom = [&](const std::filesystem::path &file, const std::regex &pattern) {
    const std::string text = contents(file);
    for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it)
      declare(parameters, (*it)[1], (*it)[2]);
  };
  addFrom(sources() / "plugins/pointbased/plugin/src/base/parameters.cpp",
          std::regex(R"rx(\{\s*"([a-z0-9_]+\.[a-z0-9_.]+)",\s*"([^"]+)")rx"));
  addFrom(sources() / "framework/abi/include/c3de/abi/iface/parameter_ids.h",
          std::regex(R"rx("([a-z0-9_]+\.[a-z0-9_.]+)"()())rx"));
  return parameters;
}

/// The text of every statement's string literals, adjacent ones joined.
std::vector<std::string> literals(const std::string &source) {
  std::vector<std::string> out;
  static const std::regex kLiteral(R"rx("((?:[^"\\\n]|\\.)*)")rx");
  std::string joined;
  std::ptrdiff_t before = -1;
  for (std::sregex_iterator it(source.begin(), source.end(), kLiteral), end; it != end; ++it) {
    const bool isJoined = before >= 0 && source.substr(static_cast<std::size_t>(before),
                                                       static_cast<std::size_t>(it->position() - before))
                                                 .find_first_not_of(" \n") == std::string::npos;
    if (!isJoined && !joined.empty()) out.push_back(std::exchange(joined, {}));
    joined += (*it)[1];
    before = it->position() + it->length();
  }
  if (!joined.empty()) out.push_back(joined);
  return out;
}

}  // namespace

TEST_CASE("ids of parameters become the labels of the panel, and the rest of a text stays") {
  const registry::ParameterRegistry parameters = few();
  const auto words = [&](const char *text) { return plainWords(text, parameters); };
  CHECK(words("abandoned after 1 s (solver.step_budget), the previous state is kept") ==
        "abandoned after 1 s (“Time for a step”), the previous state is kept");
  CHECK(words("a smaller solver.dt.") == "a smaller “Step”.");
  CHECK(words("(contact.pair, contact.self)") == "(“pair”, “Contact with itself”)");
  CHECK(words("solver.load_steps") == "“load steps”");
  CHECK(words("solver.dt = 1.5e-3 s; E = 2.5") == "“Step” = 1.5e-3 s; E = 2.5");
  for (const char *text : {"liver.nii.gz of scan.dcm", "/home/solver.dt/a.toml", "see docs/user/accuracy.md",
                           "scene.toml:3: unknown key 'solver.dtt'; did you mean 'solver.dt'?", "e.g. this.",
                           "1.5 mm … 2.5 mm", "", "rigid", "± 0.87 mm (95 % of the skin)", "3.x.y"})
    CHECK(words(text) == text);
}

TEST_CASE("ids of interfaces and classes are taken out of a text") {
  const registry::ParameterRegistry parameters = few();
  CHECK(plainWords("no class answers c3de.iface.simulator/1; look", parameters) ==
        "no class answers an interface of the program; look");
  CHECK(plainWords("draft/c3de.grasp/0", parameters) == "an interface of the program");
  CHECK(plainWords("2026/11, 1/60 s", parameters) == "2026/11, 1/60 s");
}

TEST_CASE("messages are worded when they are shown") {
  registry::ParameterRegistry parameters = few();
  registry::PanelRegistry panels;
  panels.setWording([&](const std::string &text) { return plainWords(text, parameters); });
  panels.notify(2, "Paused", "a smaller solver.dt helps");
  REQUIRE(panels.notifications().size() == 1);
  CHECK(panels.notifications().front().text == "a smaller “Step” helps");
  CHECK(panels.log().front().text == "a smaller “Step” helps");
}

TEST_CASE("no sentence of the program shows an id of a parameter or an interface in the window") {
  namespace fs = std::filesystem;
  const registry::ParameterRegistry parameters = ofThePlugin();
  std::size_t declared = 0;
  parameters.forEach([&](const registry::ParameterSet &) { ++declared; });
  REQUIRE(declared > 50);
  const std::regex id(
      R"rx((^|[^A-Za-z0-9_./-])(solver|sampling|material|contact|world|accuracy|surroundings|view)\.[a-z])rx"
      R"rx(|c3de\.iface)rx");
  std::size_t sentences = 0, withIds = 0;
  for (const char *folder :
       {"plugins/pointbased/core/src", "plugins/pointbased/plugin/src", "framework/session/src", "framework/scene/src",
        "framework/plugin_host/src", "framework/app/src/workstation", "framework/ui/src", "framework/segmentation/src"})
    for (const auto &entry : fs::recursive_directory_iterator(sources() / folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      std::string source = contents(entry.path());
      // Quotation marks within a literal are shown to the user.
      for (std::size_t at; (at = source.find("\\\"")) != std::string::npos;) source.replace(at, 2, "''");
      for (const std::string &text : literals(source)) {
        if (text.find(' ') == std::string::npos) continue;
        ++sentences;
        if (!std::regex_search(text, id)) continue;
        ++withIds;
        INFO(entry.path() << ": " << text);
        CHECK_FALSE(std::regex_search(plainWords(text, parameters), id));
      }
    }
  CHECK(sentences > 1000);
  CHECK(withIds > 20);
}
