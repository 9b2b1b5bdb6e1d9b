// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include "c3de/manual/manual.h"
#include "declared_option.h"

namespace c3de::manual {
namespace {

/// A word of the generated script; names of options and commands need no quotes.
std::string joined(const std::vector<std::string> &words, char between) {
  std::string out;
  for (const std::string &word : words) out += (out.empty() ? "" : std::string(1, between)) + word;
  return out;
}

std::string completionOf(const DeclaredOption &option, const std::string &function) {
  switch (option.kind) {
    case ValueKind::choice: return function + "_words '" + joined(option.choices, ' ') + "'";
    case ValueKind::file: return function + "_files " + option.extension;
    case ValueKind::folder: return function + "_folders";
    case ValueKind::text:
    case ValueKind::none: break;
  }
  return ":";
}

/// Cases of options with a value, and what arguments and options there are.
void writeLevel(std::ostringstream &values, std::ostringstream &words, const CLI::App &app, const std::string &command,
                const std::string &function) {
  std::vector<std::string> names;
  for (const DeclaredOption &option : optionsOf(app)) {
    names.insert(names.end(), option.names.begin(), option.names.end());
    if (option.type.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string &name : option.names) patterns.push_back(command + ":" + name);
    values << "    " << joined(patterns, '|') << ") " << completionOf(option, function) << "; return ;;\n";
  }
  const auto arguments = argumentsOf(app);
  words << "    " << command << ":options) " << function << "_words '" << joined(names, ' ') << "' ;;\n"
        << "    " << command << ":arguments) " << (arguments.empty() ? ":" : completionOf(arguments.front(), function));
  if (std::vector<std::string> commands; command.empty()) {
    for (const CLI::App *one : commandsOf(app)) commands.push_back(one->get_name());
    words << "; " << function << "_words '" << joined(commands, ' ') << "'";
  }
  words << " ;;\n";
}

}  // namespace

std::string bashCompletion(const CLI::App &root) {
  const std::string name = root.get_name();
  const std::string function = "_" + name;
  std::ostringstream values, words;
  std::vector<std::string> commands;
  writeLevel(values, words, root, "", function);
  for (const CLI::App *command : commandsOf(root)) {
    commands.push_back(command->get_name());
    writeLevel(values, words, *command, command->get_name(), function);
  }
  std::ostringstream out;
  out << "# Completion of " << name << " for bash, written by `" << name << " completion bash`.\n"
      << function
      << "_words() {\n  mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -W \"$1\" -- \"$cur\")\n}\n"
      << function << "_folders() {\n  compopt -o filenames 2>/dev/null\n"
      << "  mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -d -- \"$cur\")\n}\n"
      << "# Files with the extension given, and folders; without one all files.\n"
      << function << "_files() {\n  if [ -n \"${1:-}\" ]; then\n    " << function << "_folders\n"
      << "    mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -f -X \"!*.$1\" -- \"$cur\")\n"
      << "  else\n    compopt -o filenames 2>/dev/null\n"
      << "    mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -f -- \"$cur\")\n  fi\n}\n"
      << function << "() {\n  local cur=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]} command= i\n"
      << "  COMPREPLY=()\n  for ((i = 1; i < COMP_CWORD; ++i)); do\n    case ${COMP_WORDS[i]} in\n      "
      << joined(commands, '|') << ") command=${COMP_WORDS[i]}; break ;;\n    esac\n  done\n"
      << "  # --option=value is three words.\n  if [ \"$cur\" = = ]; then\n    cur=\n"
      << "  elif [ \"$option\" = = ] && [ \"$COMP_CWORD\" -ge 2 ]; then\n    option=${COMP_WORDS[COMP_CWORD - 2]}\n  "
         "fi\n"
      << "  case $command:$option in\n"
      << values.str() << "  esac\n  local wanted=arguments\n  [[ $cur != -* ]] || wanted=options\n"
      << "  case $command:$wanted in\n"
      << words.str() << "  esac\n}\ncomplete -F " << function << " " << name << "\n";
  return out.str();
}

}  // namespace c3de::manual
