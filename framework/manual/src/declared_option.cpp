// SPDX-License-Identifier: Apache-2.0
#include "declared_option.h"

#include <algorithm>
#include <array>

namespace c3de::manual {
namespace {

/// Of "UNIT:{m,mm,cm}" the members, and "UNIT" stays.
std::vector<std::string> takeChoices(std::string &type) {
  const std::size_t begin = type.find(":{");
  const std::size_t end = type.find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) return {};
  std::vector<std::string> choices = CLI::detail::split(type.substr(begin + 2, end - begin - 2), ',');
  type.erase(begin);
  return choices;
}

ValueKind kindOf(const std::string &type) {
  static constexpr std::array kFolders{"DIR", "FOLDER"};
  static constexpr std::array kFiles{"PATH", "PLUGIN", "PLUGINS", "SCENE", "STUDY", "RECORDING"};
  if (type.empty()) return ValueKind::none;
  if (std::find(kFolders.begin(), kFolders.end(), type) != kFolders.end()) return ValueKind::folder;
  const bool isFile = type.rfind("FILE", 0) == 0 || std::find(kFiles.begin(), kFiles.end(), type) != kFiles.end();
  return isFile ? ValueKind::file : ValueKind::text;
}

DeclaredOption describe(const CLI::Option &option, bool isArgument) {
  DeclaredOption out;
  if (isArgument) {
    out.names = {option.get_name(true, false)};
  } else {
    for (const std::string &name : option.get_snames()) out.names.push_back("-" + name);
    for (const std::string &name : option.get_lnames()) out.names.push_back("--" + name);
  }
  if (option.get_type_size() != 0) out.type = option.get_type_name();
  out.choices = takeChoices(out.type);
  // Other checks describe themselves in the same text: "INT in [0 - 1000]".
  if (const std::size_t colon = out.type.find(':');
      colon != std::string::npos && out.type.find(' ', colon) != std::string::npos)
    out.type.erase(colon);
  out.kind = !out.choices.empty() ? ValueKind::choice : kindOf(isArgument ? out.names.front() : out.type);
  if (out.kind == ValueKind::file)
    if (const std::size_t dot = out.type.find('.'); dot != std::string::npos) out.extension = out.type.substr(dot + 1);
  if (isArgument && out.names.front() == "RECORDING") out.extension = "c3dr";
  if (isArgument && out.names.front() == "STUDY") out.extension = "toml";
  out.fallback = option.get_default_str();
  out.text = option.get_description();
  out.group = option.get_group();
  out.isRequired = option.get_required();
  out.isRepeatable = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  return out;
}

std::vector<DeclaredOption> all(const CLI::App &app, bool areArguments) {
  std::vector<DeclaredOption> out;
  for (const CLI::Option *option : app.get_options())
    if (!option->get_group().empty() && option->get_positional() == areArguments)
      out.push_back(describe(*option, areArguments));
  return out;
}

}  // namespace

std::vector<DeclaredOption> optionsOf(const CLI::App &app) { return all(app, false); }
std::vector<DeclaredOption> argumentsOf(const CLI::App &app) { return all(app, true); }

std::vector<const CLI::App *> commandsOf(const CLI::App &app) {
  return app.get_subcommands([](const CLI::App *command) { return !command->get_group().empty(); });
}

}  // namespace c3de::manual
