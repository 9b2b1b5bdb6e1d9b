// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "app.h"

namespace CLI {
class App;
}

namespace c3de::app {

struct CommandLine;

/// Executes a command after the command line has been parsed. Returns the exit code.
using Handler = std::function<int()>;

/// A sub-command. To add one: command_NAME.cpp with its Command, and a line in commands.cpp.
struct Command {
  const char *name, *summary;
  /// Adds the options to `app`. The values they are parsed into belong to the handler, or are in `line`, which outlives
  /// it. Null: a name reserved for a later version.
  Handler (*declare)(CLI::App &app, CommandLine &line);
  bool isHidden = false;  ///< not in the help: for installation scripts
};

extern const Command kRunCommand, kReplayCommand, kInfoCommand, kMaterialsCommand, kParametersCommand, kPluginsCommand,
    kNewPluginCommand, kStudyCommand, kMatchCommand, kFitCommand, kPythonPathCommand, kCompletionCommand,
    kManualCommand, kHelpCommand, kVersionCommand;

/// The program without a sub-command: opens a window.
[[nodiscard]] Handler declareWorkstation(CLI::App &app, CommandLine &line);

/// All commands, in the order of the help.
[[nodiscard]] std::span<const Command *const> commands();
/// The names of the available commands: "run, info and plugins". @param last  inserted before the last one
[[nodiscard]] std::string availableCommands(std::string_view last);

}  // namespace c3de::app
