// SPDX-License-Identifier: Apache-2.0
// `c3de help [TOPIC]` and `c3de version`
#include <memory>
#include <span>
#include <vector>

#include "c3de/core/text.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"
#include "commands/topics.h"
#include "commands/version.h"

namespace c3de::app {
namespace {

constexpr const char *kEnvironmentTopic = "environment", *kExitCodesTopic = "exit-codes", *kFilesTopic = "files";

std::vector<std::string> topics() {
  std::vector<std::string> all{kEnvironmentTopic, kExitCodesTopic, kFilesTopic};
  for (const Command *command : commands())
    if (!command->isHidden) all.emplace_back(command->name);
  return all;
}

int printHelp(const CLI::App &root, const std::string &topic) {
  if (topic.empty()) {
    // App::help() prints the command that was parsed: this one.
    printOut(root.get_formatter()->make_help(&root, root.get_name(), CLI::AppFormatMode::Normal));
    return kDone;
  }
  if (topic == kEnvironmentTopic || topic == kExitCodesTopic || topic == kFilesTopic) {
    printOut(topic == kEnvironmentTopic ? "Environment variables:\n" + textOf(environmentVariables())
             : topic == kExitCodesTopic ? "Exit codes:\n" + textOf(exitCodes())
                                        : "Files:\n" + textOf(userFiles()));
    return kDone;
  }
  for (const CLI::App *command : root.get_subcommands([](const CLI::App *) { return true; }))
    if (command->get_name() == topic) {
      printOut(command->help("c3de"));
      return kDone;
    }
  const std::vector<std::string> known = topics();
  const std::string nearest = nearestName(topic, known);
  return reportError({ErrorCode::usage, "there is no help about '" + displayText(topic) + "'; " +
                                            (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                            "accepted: environment, exit-codes, files, and the commands " +
                                            availableCommands(", ")});
}

Handler declareHelp(CLI::App &app, CommandLine &) {
  const auto topic = std::make_shared<std::string>();
  std::string choices;
  for (const std::string &one : topics()) choices += (choices.empty() ? "" : ",") + one;
  app.add_option("TOPIC", *topic, "A command, environment, exit-codes or files")->check(listOfChoices(choices));
  const CLI::App *root = app.get_parent();
  return [root, topic] { return printHelp(*root, *topic); };
}

Handler declareVersion(CLI::App &app, CommandLine &line) {
  app.add_flag("--json", line.json, "As JSON, with the services of the plugin boundary");
  return [&line]() -> int {
    printVersion(line.json);
    return kDone;
  };
}

}  // namespace

const Command kHelpCommand{"help", "Help about a command, or about a topic", declareHelp};
const Command kVersionCommand{"version", "Print product and ABI, as --version does", declareVersion};

}  // namespace c3de::app
