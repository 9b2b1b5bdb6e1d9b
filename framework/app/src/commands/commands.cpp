// SPDX-License-Identifier: Apache-2.0
#include "commands/commands.h"

namespace c3de::app {
namespace {

constexpr const Command *kCommands[]{&kRunCommand,       &kReplayCommand, &kInfoCommand,      &kPluginsCommand,
                                     &kNewPluginCommand, &kStudyCommand,  &kPythonPathCommand};

}  // namespace

std::span<const Command *const> commands() { return kCommands; }

std::string availableCommands(std::string_view last) {
  std::string text, pending;
  for (const Command *command : commands()) {
    if (!command->declare) continue;
    if (!pending.empty()) text += (text.empty() ? "" : ", ") + pending;
    pending = command->name;
  }
  return text + std::string(last) + pending;
}

}  // namespace c3de::app
