// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/command_registry.h"

#include <fmt/format.h>

#include <algorithm>

namespace c3de::registry {

Expected<CommandRegistry::Added> CommandRegistry::add(PluginCommand command) {
  if (const PluginCommand *other = find(ofId(command.id)))
    return fail(ErrorCode::usage, fmt::format("the command '{}' already exists (plugin {})", command.id, other->owner));
  Added added;
  if (command.key != 0) {
    if (programKeys_) added.takenBy = programKeys_(command.key, command.modifiers);
    for (const Entry &entry : commands())
      if (entry.command->key == command.key && entry.command->modifiers == command.modifiers)
        added.takenBy = fmt::format("'{}' of {}", entry.command->title, entry.command->owner);
    if (!added.takenBy.empty()) command.key = command.modifiers = 0;
  }
  added.handle = table_.add(std::move(command));
  order_.push_back(added.handle);
  return added;
}

bool CommandRegistry::remove(Handle command) {
  std::erase(order_, command);
  return table_.remove(command);
}

void CommandRegistry::removeOwnedBy(const std::string &plugin) {
  const std::vector<Handle> all = order_;
  for (const Handle handle : all)
    if (table_.find(handle)->owner == plugin) remove(handle);
}

bool CommandRegistry::setEnabled(Handle command, bool isEnabled) {
  PluginCommand *found = table_.find(command);
  if (found) found->isEnabled = isEnabled;
  return found != nullptr;
}

std::vector<CommandRegistry::Entry> CommandRegistry::commands() const {
  std::vector<Entry> all;
  for (const Handle handle : order_) all.push_back({handle, table_.find(handle)});
  return all;
}

Handle CommandRegistry::ofKey(std::uint32_t key, std::uint32_t modifiers) const {
  if (key == 0) return {};
  for (const Entry &entry : commands())
    if (entry.command->key == key && entry.command->modifiers == modifiers && entry.command->isEnabled)
      return entry.handle;
  return {};
}

Handle CommandRegistry::ofId(const std::string &id) const {
  for (const Entry &entry : commands())
    if (entry.command->id == id) return entry.handle;
  return {};
}

CommandResult CommandRegistry::run(Handle command) {
  const PluginCommand *found = find(command);
  if (!found) return {C3DE_E_STALE, "the command no longer exists"};
  if (!found->isEnabled) return {C3DE_E_STATE, fmt::format("the command '{}' is not enabled now", found->title)};
  if (std::find(running_.begin(), running_.end(), command) != running_.end())
    return {C3DE_E_STATE, fmt::format("the command '{}' is running already", found->title)};
  const std::function<CommandResult()> run = found->run;  // a copy, since the command may remove itself
  running_.push_back(command);
  CommandResult result = run();
  std::erase(running_, command);
  return result;
}

}  // namespace c3de::registry
