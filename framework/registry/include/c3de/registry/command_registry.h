// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/commands.h"
#include "c3de/core/expected.h"
#include "c3de/core/handle.h"

namespace c3de::registry {

/// Result of a plugin's command, with the text of a failure.
struct CommandResult {
  c3de_status status = C3DE_OK;
  std::string text;
};

struct PluginCommand {
  std::string owner;  ///< plugin id
  std::string id, title, doc;
  std::uint32_t key = 0;        ///< 0: none
  std::uint32_t modifiers = 0;  ///< C3DE_MOD_*
  bool isEnabled = true;
  std::function<CommandResult()> run;
};

/// The commands that plugins have registered. Main thread only.
class CommandRegistry {
 public:
  /// Sets the function that returns the display name of the program's command with these keys; empty if there is none.
  /// Called before plugins are loaded.
  void setProgramKeys(std::function<std::string(std::uint32_t key, std::uint32_t modifiers)> nameOf) {
    programKeys_ = std::move(nameOf);
  }

  struct Added {
    Handle handle;
    std::string takenBy;  ///< owner of the requested keys; the command was then added without keys
  };
  /// Refused (ErrorCode::usage) if the id is in use; the error names the owner.
  [[nodiscard]] Expected<Added> add(PluginCommand command);
  bool remove(Handle command);
  void removeOwnedBy(const std::string &plugin);
  bool setEnabled(Handle command, bool isEnabled);

  struct Entry {
    Handle handle;
    const PluginCommand *command;
  };
  [[nodiscard]] const PluginCommand *find(Handle command) const { return table_.find(command); }
  [[nodiscard]] std::vector<Entry> commands() const;  ///< in the order in which they were added
  /// Null if there is none, or none that is enabled.
  [[nodiscard]] Handle ofKey(std::uint32_t key, std::uint32_t modifiers) const;
  /// Null if there is none.
  [[nodiscard]] Handle ofId(const std::string &id) const;
  /// C3DE_E_STALE, C3DE_E_STATE (not enabled, or already running), or the result of the command.
  [[nodiscard]] CommandResult run(Handle command);

 private:
  HandleTable<PluginCommand, HandleKind::command> table_;
  std::vector<Handle> order_;
  std::vector<Handle> running_;
  std::function<std::string(std::uint32_t, std::uint32_t)> programKeys_;
};

}  // namespace c3de::registry
