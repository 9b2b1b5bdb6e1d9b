// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "c3de/manual/manual.h"
#include "declared_option.h"

namespace c3de::manual {
namespace {

/// Running text for roff. A hyphen that may be typed by the reader is a minus there.
std::string escaped(const std::string &text) {
  std::string out;
  for (const char letter : text) {
    const bool isLineBegin = out.empty() || out.back() == '\n';
    if (isLineBegin && (letter == '.' || letter == '\'')) out += "\\&";
    if (letter == '\\')
      out += "\\e";
    else if (letter == '-')
      out += "\\-";
    else
      out += letter;
  }
  return out;
}

/// An argument of a macro.
std::string quoted(const std::string &text) {
  std::string out = "\"";
  for (const char letter : escaped(text)) out += letter == '"' ? std::string("\\(dq") : std::string(1, letter);
  return out + "\"";
}

std::string firstLine(const std::string &text) { return text.substr(0, text.find('\n')); }

std::string headOf(const DeclaredOption &option) {
  std::string head;
  for (const std::string &name : option.names) head += (head.empty() ? "\\fB" : ", \\fB") + escaped(name) + "\\fR";
  if (!option.type.empty()) head += " \\fI" + escaped(option.type) + "\\fR";
  return head;
}

std::string bodyOf(const DeclaredOption &option) {
  std::string text = option.text;
  std::string choices;
  for (const std::string &choice : option.choices) choices += (choices.empty() ? "" : ", ") + choice;
  if (!choices.empty()) text += ". Accepted: " + choices;
  if (!option.fallback.empty()) text += ". Default: " + option.fallback;
  if (option.isRequired) text += ". Required";
  return escaped(text) + ".\n";
}

void writeArguments(std::ostringstream &out, const CLI::App &app) {
  const auto arguments = argumentsOf(app);
  if (arguments.empty()) return;
  out << ".SH ARGUMENTS\n";
  for (const DeclaredOption &argument : arguments)
    out << ".TP\n\\fI" << escaped(argument.names.front()) << "\\fR\n" << bodyOf(argument);
}

void writeOptions(std::ostringstream &out, const CLI::App &app) {
  const auto options = optionsOf(app);
  if (options.empty()) return;
  std::vector<std::string> groups;
  for (const DeclaredOption &option : options)
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  out << ".SH OPTIONS\n";
  for (const std::string &group : groups) {
    if (groups.size() > 1) out << ".SS " << quoted(group) << "\n";
    for (const DeclaredOption &option : options)
      if (option.group == group) out << ".TP\n" << headOf(option) << "\n" << bodyOf(option);
  }
}

void writeCommands(std::ostringstream &out, const CLI::App &app) {
  const auto commands = commandsOf(app);
  if (commands.empty()) return;
  out << ".SH COMMANDS\n";
  for (const CLI::App *command : commands)
    out << ".TP\n\\fB" << escaped(command->get_name()) << "\\fR\n"
        << escaped(firstLine(command->get_description())) << ".\n";
}

/// The footer of --help: a title and indented lines.
void writeExamples(std::ostringstream &out, const CLI::App &app) {
  std::istringstream lines(app.get_footer());
  std::string line;
  bool isFirst = true;
  while (std::getline(lines, line)) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || line.ends_with(':')) continue;
    if (isFirst) out << ".SH EXAMPLES\n.nf\n";
    isFirst = false;
    out << escaped(line.substr(begin)) << "\n";
  }
  if (!isFirst) out << ".fi\n";
}

}  // namespace

std::string manPage(const CLI::App &app, const PageFacts &facts) {
  std::string title = facts.name;
  std::transform(title.begin(), title.end(), title.begin(), [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  });
  std::ostringstream out;
  out << ".TH " << quoted(title) << " 1 " << quoted(facts.date) << " " << quoted("C3DE " + facts.version)
      << " \"C3DE\"\n"
      << ".SH NAME\n"
      << escaped(facts.name) << " \\- " << escaped(firstLine(app.get_description())) << "\n"
      << ".SH SYNOPSIS\n\\fB" << escaped(facts.call) << "\\fR [\\fIOPTIONS\\fR]";
  for (const DeclaredOption &argument : argumentsOf(app)) {
    const std::string name = "\\fI" + escaped(argument.names.front()) + "\\fR" + (argument.isRepeatable ? "..." : "");
    out << " " << (argument.isRequired ? name : "[" + name + "]");
  }
  out << "\n";
  if (!commandsOf(app).empty())
    out << ".br\n\\fB" << escaped(facts.call) << "\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] [\\fIARGUMENTS\\fR]\n";
  out << ".SH DESCRIPTION\n" << escaped(app.get_description()) << "\n";
  writeArguments(out, app);
  writeOptions(out, app);
  writeCommands(out, app);
  for (const Section &section : facts.sections) {
    out << ".SH " << quoted(section.title) << "\n";
    for (const auto &[term, text] : section.entries)
      out << ".TP\n\\fB" << escaped(term) << "\\fR\n" << escaped(text) << "\n";
  }
  writeExamples(out, app);
  if (!facts.seeAlso.empty()) out << ".SH \"SEE ALSO\"\n";
  for (std::size_t i = 0; i < facts.seeAlso.size(); ++i)
    out << escaped(facts.seeAlso[i]) << (i + 1 < facts.seeAlso.size() ? ",\n" : "\n");
  return out.str();
}

}  // namespace c3de::manual
