// SPDX-License-Identifier: Apache-2.0
#include "commands/commands.h"

namespace c3de::app {
namespace {

constexpr const Command *kCommands[]{&kRunCommand,    &kReplayCommand,    &kMatchCommand,      &kFitCommand,
                                     &kInfoCommand,   &kMaterialsCommand, &kParametersCommand, &kPluginsCommand,
                                     &kStudyCommand,  &kNewPluginCommand, &kPythonPathCommand, &kCompletionCommand,
                                     &kManualCommand, &kHelpCommand,      &kVersionCommand};

}  // namespace

std::span<const Command *const> commands() { return kCommands; }

std::string availableCommands(std::string_view last) {
  std::string text, pending;
  for (const Command *command : commands()) {
    if (!command->declare || command->isHidden) continue;
    if (!pending.empty()) text += (text.empty() ? "" : ", ") + pending;
    pending = command->name;
  }
  return text + std::string(last) + pending;
}

}  // namespace c3de::app
