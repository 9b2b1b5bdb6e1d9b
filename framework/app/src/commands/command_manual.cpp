// SPDX-License-Identifier: Apache-2.0
// `c3de completion SHELL`, and `c3de write-manual FOLDER`, which an installation runs.
#include <filesystem>
#include <memory>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/manual/manual.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"
#include "commands/topics.h"

namespace c3de::app {
namespace {

manual::Section section(const char *title, std::span<const TopicEntry> entries) {
  manual::Section out{title, {}};
  for (const TopicEntry &entry : entries) out.entries.emplace_back(entry.term, entry.text);
  return out;
}

/// c3de(1) has what holds for all commands; c3de-NAME(1) has one command.
std::vector<std::pair<std::string, std::string>> pagesOf(const CLI::App &root, const std::string &date) {
  manual::PageFacts facts{"c3de", "c3de", C3DE_VERSION, date, {}, {}};
  facts.sections = {section("ENVIRONMENT", environmentVariables()), section("EXIT STATUS", exitCodes()),
                    section("FILES", userFiles())};
  const auto commands = root.get_subcommands([](const CLI::App *command) { return !command->get_group().empty(); });
  for (const CLI::App *command : commands) facts.seeAlso.push_back("c3de-" + command->get_name() + "(1)");
  facts.seeAlso.emplace_back("c3de-validate(1)");
  std::vector<std::pair<std::string, std::string>> pages{{facts.name, manual::manPage(root, facts)}};
  for (const CLI::App *command : commands) {
    const std::string name = command->get_name();
    pages.emplace_back(
        "c3de-" + name,
        manual::manPage(
            *command,
            {"c3de-" + name, "c3de " + name, C3DE_VERSION, date, {section("EXIT STATUS", exitCodes())}, {"c3de(1)"}}));
  }
#ifndef _WIN32
  // Programs that `c3de` continues in.
  pages.emplace_back("c3de-workstation", ".so man1/c3de.1\n");
  pages.emplace_back("c3de-study-mpi", ".so man1/c3de-study.1\n");
#endif
  return pages;
}

/// FOLDER/man1/*.1, FOLDER/c3de.bash and FOLDER/_c3de.
int writeManual(const CLI::App &root, const std::filesystem::path &folder, const std::string &date) {
  const std::filesystem::path man = folder / "man1";
  std::error_code code;
  std::filesystem::create_directories(man, code);
  if (code) return reportError({ErrorCode::output, pathText(man) + ": cannot be made: " + code.message()});
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  for (auto &[name, text] : pagesOf(root, date)) files.emplace_back(man / (name + ".1"), std::move(text));
  files.emplace_back(folder / "c3de.bash", manual::bashCompletion(root));
  files.emplace_back(folder / "_c3de", manual::zshCompletion(root));
  for (const auto &[file, text] : files)
    if (const auto written = writeWholeFile(file, text); !written) return reportError(written.error());
  return kDone;
}

Handler declareManual(CLI::App &app, CommandLine &) {
  struct Arguments {
    std::filesystem::path folder;
    std::string date;
  };
  const auto arguments = std::make_shared<Arguments>();
  app.add_option_function<std::string>(
         "FOLDER", [arguments](const std::string &text) { arguments->folder = text; }, "Where they are written")
      ->required();
  app.add_option("--date", arguments->date, "Of the pages, for example 2026-01-31")->type_name("DATE");
  const CLI::App *root = app.get_parent();
  return [root, arguments] { return writeManual(*root, arguments->folder, arguments->date); };
}

Handler declareCompletion(CLI::App &app, CommandLine &) {
  const auto shell = std::make_shared<std::string>();
  app.add_option("SHELL", *shell, "bash or zsh")->required()->check(listOfChoices("bash,zsh"));
  app.footer(
      "Examples:\n"
      "    eval \"$(c3de completion bash)\"                  # in ~/.bashrc; a package installs it\n"
      "    c3de completion zsh >~/.zsh/functions/_c3de     # a folder of fpath");
  const CLI::App *root = app.get_parent();
  return [root, shell]() -> int {
    if (*shell != "bash" && *shell != "zsh")
      return reportError({ErrorCode::usage, "completion " + *shell + ": accepted: bash, zsh"});
    printOut(*shell == "bash" ? manual::bashCompletion(*root) : manual::zshCompletion(*root));
    return kDone;
  };
}

}  // namespace

const Command kCompletionCommand{"completion", "Print a script that completes commands and options in a shell",
                                 declareCompletion};
const Command kManualCommand{"write-manual", "Write man pages and completion scripts", declareManual, true};

}  // namespace c3de::app
