// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/core/log.h"
#include "c3de/core/text.h"
#include "c3de/registry/command_registry.h"
#include "last_error.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

constexpr std::uint32_t kModifiers = C3DE_MOD_SHIFT | C3DE_MOD_CTRL | C3DE_MOD_ALT;

void checkShortcut(const c3de_command &in) {
  if (in.modifiers & ~kModifiers)
    throw Refusal(C3DE_E_ARG, fmt::format("modifiers are {:#x}, accepted: C3DE_MOD_SHIFT, _CTRL and _ALT ({:#x})",
                                          in.modifiers, kModifiers));
  if (in.key == 0) return;
  if (!(in.key >= 'A' && in.key <= 'Z') && !(in.key >= '0' && in.key <= '9'))
    throw Refusal(C3DE_E_ARG, fmt::format("key is {}, accepted: 0 (none), 'A' to 'Z', '0' to '9'", in.key));
  if (!(in.modifiers & (C3DE_MOD_CTRL | C3DE_MOD_ALT)))
    throw Refusal(C3DE_E_ARG, fmt::format("key '{}' comes without C3DE_MOD_CTRL and C3DE_MOD_ALT; keys alone are for "
                                          "tools",
                                          static_cast<char>(in.key)));
}

/// A command owned by the plugin. Throws Refusal.
Handle own(PluginContext &plugin, c3de_handle command) {
  const registry::PluginCommand *found = plugin.services().commands->find(handleOf(command));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no command of handle {}", textOf(command)));
  if (found->owner != plugin.id())
    throw Refusal(C3DE_E_STATE, fmt::format("the command '{}' belongs to plugin {}", found->title, found->owner));
  return handleOf(command);
}

c3de_status C3DE_CALL add(void *ctx, const c3de_command *command, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "commands.add", [&](PluginContext &plugin) -> c3de_status {
    requireNonNull(out, "out")->v = 0;
    const c3de_command in = structOf(command, "command");
    registry::PluginCommand made;
    made.owner = plugin.id();
    made.id = idOf(in.id, "command id");
    made.title = textOf(in.title, "command title");
    made.doc = textOf(in.doc, "command doc");
    if (made.title.empty()) throw Refusal(C3DE_E_ARG, "command title is empty");
    checkShortcut(in);
    made.key = in.key;
    made.modifiers = in.key == 0 ? 0 : in.modifiers;
    requireNonNull(in.run, "command run");
    made.run = [owner = &plugin, in] {
      registry::CommandResult result{C3DE_E_EXCEPTION, {}};
      setLastError(std::string_view());
      if (!callPlugin(*owner, "run of a command", [&] { result.status = in.run(in.self); }))
        result.text = "an exception left it; the log says which";
      else if (result.status < 0)
        result.text = takeLastError();
      if (result.status < 0 && result.text.empty()) result.text = "it fails with " + statusName(result.status);
      return result;
    };
    const std::string title = made.title;
    const auto added = plugin.services().commands->add(std::move(made));
    if (!added) throw Refusal(C3DE_E_EXISTS, added.error().message);
    writeHandle(out, added->handle);
    if (added->takenBy.empty()) return C3DE_OK;
    log(LogLevel::warn, fmt::format("[{}] the command '{}' has no shortcut: its keys are those of {}", plugin.id(),
                                    title, added->takenBy));
    return C3DE_S_NO_SHORTCUT;
  });
}

c3de_status C3DE_CALL removeCommand(void *ctx, c3de_handle command) noexcept {
  return serveOnMain(ctx, "commands.remove",
                     [&](PluginContext &plugin) { plugin.services().commands->remove(own(plugin, command)); });
}

c3de_status C3DE_CALL setEnabled(void *ctx, c3de_handle command, std::uint32_t enabled) noexcept {
  return serveOnMain(ctx, "commands.set_enabled", [&](PluginContext &plugin) {
    plugin.services().commands->setEnabled(own(plugin, command), enabled != 0);
  });
}

c3de_status C3DE_CALL run(void *ctx, c3de_str id) noexcept {
  return serveOnMain(ctx, "commands.run", [&](PluginContext &plugin) -> c3de_status {
    registry::CommandRegistry &commands = *plugin.services().commands;
    const std::string name = textOf(id, "id");
    const Handle found = commands.ofId(name);
    if (found.isNull()) {
      std::vector<std::string> known;
      for (const auto &entry : commands.commands()) known.push_back(entry.command->id);
      const std::string nearest = nearestName(name, known);
      throw Refusal(C3DE_E_NOT_FOUND, fmt::format("there is no command '{}'{}", name,
                                                  nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    const registry::CommandResult result = commands.run(found);
    if (result.status < 0) throw Refusal(result.status, name + ": " + result.text);
    return result.status;
  });
}

}  // namespace

c3de_commands_v1 makeCommandsTable(PluginContext *plugin) {
  return {sizeof(c3de_commands_v1), kServiceRevision, plugin, &add, &removeCommand, &setEnabled, &run};
}

}  // namespace c3de::plugin_host
