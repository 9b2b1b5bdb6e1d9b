// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "c3de/manual/manual.h"
#include "declared_option.h"

namespace c3de::manual {
namespace {

/// Text within a specification of _arguments, in single quotes.
std::string inSpecification(const std::string &text) {
  std::string out;
  for (const char letter : text.substr(0, text.find('\n'))) {
    if (letter == '\'') {
      out += "'\\''";
      continue;
    }
    if (letter == '[' || letter == ']' || letter == ':' || letter == '\\') out += '\\';
    out += letter;
  }
  return out;
}

std::string valueOf(const DeclaredOption &option) {
  const std::string what = ":" + inSpecification(option.type.empty() ? option.names.front() : option.type) + ":";
  std::string choices;
  switch (option.kind) {
    case ValueKind::none: return {};
    case ValueKind::text: return what;
    case ValueKind::choice:
      for (const std::string &choice : option.choices) choices += (choices.empty() ? "" : " ") + choice;
      return what + "(" + choices + ")";
    case ValueKind::file:
      return what + (option.extension.empty() ? "_files" : "_files -g \"*." + option.extension + "\"");
    case ValueKind::folder: return what + "_files -/";
  }
  return {};
}

std::string specificationsOf(const CLI::App &app) {
  std::string out;
  for (const DeclaredOption &option : optionsOf(app))
    for (const std::string &name : option.names)
      out += std::string(" \\\n    '") + (option.isRepeatable ? "*" : "") + name +
             (!option.type.empty() && name.starts_with("--") ? "=" : "") + "[" + inSpecification(option.text) + "]" +
             (option.type.empty() ? "" : valueOf(option)) + "'";
  return out;
}

std::string functionName(const std::string &root, std::string command) {
  std::replace(command.begin(), command.end(), '-', '_');
  return "_" + root + "_" + command;
}

}  // namespace

std::string zshCompletion(const CLI::App &root) {
  const std::string name = root.get_name();
  std::ostringstream out;
  out << "#compdef " << name << "\n# Completion of " << name << " for zsh, written by `" << name
      << " completion zsh`.\n";
  for (const CLI::App *command : commandsOf(root)) {
    out << functionName(name, command->get_name()) << "() {\n  _arguments" << specificationsOf(*command);
    for (const DeclaredOption &argument : argumentsOf(*command))
      out << " \\\n    '" << (argument.isRepeatable ? "*" : "") << valueOf(argument) << "'";
    out << "\n}\n";
  }
  out << "_" << name << "() {\n  local curcontext=$curcontext state line\n  _arguments -C" << specificationsOf(root)
      << " \\\n    '1:command or file:->first' \\\n    '*::arguments:->rest'\n  case $state in\n    first)\n"
      << "      local -a commands=(\n";
  for (const CLI::App *command : commandsOf(root))
    out << "        '" << command->get_name() << ":" << inSpecification(command->get_description()) << "'\n";
  out << "      )\n      _describe command commands\n      _files\n      ;;\n    rest)\n      case $words[1] in\n";
  for (const CLI::App *command : commandsOf(root))
    out << "        " << command->get_name() << ") " << functionName(name, command->get_name()) << " ;;\n";
  out << "        *) _files ;;\n      esac\n      ;;\n  esac\n}\n_" << name << " \"$@\"\n";
  return out.str();
}

}  // namespace c3de::manual
