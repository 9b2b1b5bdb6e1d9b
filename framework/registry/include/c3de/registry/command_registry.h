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

/// What a command of a plugin gave, with the text where it failed.
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
  /// Which command of the program has these keys, for people; empty: none. Before plugins are loaded.
  void setProgramKeys(std::function<std::string(std::uint32_t key, std::uint32_t modifiers)> nameOf) {
    programKeys_ = std::move(nameOf);
  }

  struct Added {
    Handle handle;
    std::string takenBy;  ///< who has its keys; it was added without them then
  };
  /// Refused (ErrorCode::usage) where the id is taken; the error names by whom.
  [[nodiscard]] Expected<Added> add(PluginCommand command);
  bool remove(Handle command);
  void removeOwnedBy(const std::string &plugin);
  bool setEnabled(Handle command, bool isEnabled);

  struct Entry {
    Handle handle;
    const PluginCommand *command;
  };
  [[nodiscard]] const PluginCommand *find(Handle command) const { return table_.find(command); }
  [[nodiscard]] std::vector<Entry> commands() const;  ///< in the order they were added
  /// Null: none, or none that is enabled.
  [[nodiscard]] Handle ofKey(std::uint32_t key, std::uint32_t modifiers) const;
  /// Null: none.
  [[nodiscard]] Handle ofId(const std::string &id) const;
  /// C3DE_E_STALE, C3DE_E_STATE (not enabled, or running already), or what it gave.
  [[nodiscard]] CommandResult run(Handle command);

 private:
  HandleTable<PluginCommand, HandleKind::command> table_;
  std::vector<Handle> order_;
  std::vector<Handle> running_;
  std::function<std::string(std::uint32_t, std::uint32_t)> programKeys_;
};

}  // namespace c3de::registry
