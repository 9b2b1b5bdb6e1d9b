// SPDX-License-Identifier: Apache-2.0
// `c3de parameters`: what a simulator declares, by the keys of `--set`.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "c3de/core/text.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;

struct Scope {
  std::uint32_t id;
  const char *name;
  const char *title;
  const char *prefix;  ///< of the keys
};

constexpr std::array kScopes{Scope{C3DE_SIM_SCOPE_WORLD, "world", "Of the scene", ""},
                             Scope{C3DE_SIM_SCOPE_BODY, "body", "Of a body", "body.NAME."},
                             Scope{C3DE_SIM_SCOPE_OBSTACLE, "obstacle", "Of an obstacle", "obstacle.NAME."}};

using Declarations = std::array<std::vector<ParameterDecl>, kScopes.size()>;

/// A bound that is not declared is null.
Json bound(double value) { return std::abs(value) < std::numeric_limits<double>::max() ? Json(value) : Json(); }

Json asJson(const Scope &scope, const ParameterDecl &decl) {
  const bool isNumber = decl.type == C3DE_PARAM_F64 || decl.type == C3DE_PARAM_I64;
  Json json{{"key", scope.prefix + decl.id},
            {"scope", scope.name},
            {"label", decl.label},
            {"unit", decl.unit},
            {"default", decl.fallbackValue().display()},
            {"accepted", decl.accepted()}};
  if (isNumber && decl.min < decl.max) {
    json["min"] = bound(decl.min);
    json["max"] = bound(decl.max);
  }
  if (!decl.choices.empty()) json["choices"] = decl.choices;
  if (!decl.alternativeTo.empty()) json["instead_of"] = scope.prefix + decl.alternativeTo;
  json["doc"] = decl.doc;
  return json;
}

std::string asText(const Scope &scope, const ParameterDecl &decl) {
  const std::string value = decl.fallbackValue().display();
  return fmt::format("  {}{}={}{}\n      {}; accepted: {}\n", scope.prefix, decl.id, value,
                     decl.unit.empty() || decl.unit == "1" ? "" : " " + decl.unit, decl.label, decl.accepted());
}

Expected<Declarations> declarationsOf(Session &session, const std::string &classId, SimulatorIdentity &identity) {
  auto chosen = session.chooseSimulator(classId);
  if (!chosen) return tl::unexpected(chosen.error());
  identity = std::move(*chosen);
  auto created = session.createSimulator(identity.classId);
  if (!created) return tl::unexpected(created.error());
  const ObjectRef simulator(*created);
  Declarations all;
  for (std::size_t i = 0; i < kScopes.size(); ++i) {
    auto decls = simulatorDeclarations(simulator.get(), kScopes[i].id);
    if (!decls) return tl::unexpected(decls.error());
    all[i] = std::move(*decls);
  }
  return all;
}

int printParameters(const CommandLine &line, const std::string &classId) {
  SessionOptions options = line.sessionOptions();
  if (!line.threads) options.threads = 1;
  auto session = Session::create(options);
  if (!session) return reportError(session.error());
  SimulatorIdentity identity;
  const auto all = declarationsOf(**session, classId, identity);
  if (!all) return reportError(all.error());
  if (line.json) {
    Json json{{"simulator", identity.classId}, {"parameters", Json::array()}};
    for (std::size_t i = 0; i < kScopes.size(); ++i)
      for (const ParameterDecl &decl : (*all)[i]) json["parameters"].push_back(asJson(kScopes[i], decl));
    printOut(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    return kDone;
  }
  std::string text = "Parameters of " + identity.classId + ", as --set accepts them, with their defaults:\n";
  for (std::size_t i = 0; i < kScopes.size(); ++i) {
    if ((*all)[i].empty()) continue;
    text += std::string("\n") + kScopes[i].title + ":\n";
    for (const ParameterDecl &decl : (*all)[i]) text += asText(kScopes[i], decl);
  }
  printOut(text);
  return kDone;
}

Handler declareParameters(CLI::App &app, CommandLine &line) {
  const auto classId = std::make_shared<std::string>();
  app.add_option("--simulator", *classId, "Class of the simulator; default: the only one there is")->type_name("CLASS");
  app.add_flag("--json", line.json, "As JSON, with the text of each parameter");
  addSessionOptions(app, line);
  app.footer(
      "Examples:\n"
      "    c3de parameters\n"
      "    c3de parameters --json\n"
      "    c3de parameters --plugin build/my_simulator.so --simulator org.example.mine");
  return [classId, &line] { return printParameters(line, *classId); };
}

}  // namespace

const Command kParametersCommand{"parameters", "Parameters of the simulator: keys of --set, units, ranges, defaults",
                                 declareParameters};

}  // namespace c3de::app
