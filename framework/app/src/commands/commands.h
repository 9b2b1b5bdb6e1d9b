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

/// What a command does once the command line has been parsed. Returns the exit code.
using Handler = std::function<int()>;

/// A sub-command. A new one: command_NAME.cpp with its Command, and a line in commands.cpp.
struct Command {
  const char *name, *summary;
  /// Adds the options to `app`. What they are parsed into belongs to the handler, or is in `line`, which outlives it.
  /// Null: a name that is kept for a later version.
  Handler (*declare)(CLI::App &app, CommandLine &line);
};

extern const Command kRunCommand, kInfoCommand, kPluginsCommand, kNewPluginCommand, kStudyCommand;

/// The program without a sub-command: opens a window.
[[nodiscard]] Handler declareWorkstation(CLI::App &app, CommandLine &line);

/// All, in the order of the help.
[[nodiscard]] std::span<const Command *const> commands();
/// The names of those that are served: "run, info and plugins". @param last  before the last one
[[nodiscard]] std::string servedCommands(std::string_view last);

}  // namespace c3de::app
