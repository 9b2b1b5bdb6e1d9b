// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "arguments.h"
#include "c3de/registry/tool_registry.h"
#include "last_error.h"
#include "services/callbacks.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

bool isLive(PluginContext &plugin, c3de_handle tool) {
  for (const registry::ToolRegistry::Entry &entry : plugin.services().tools->tools())
    if (entry.handle == handleOf(tool)) return true;
  return false;
}

void requireLive(PluginContext &plugin, c3de_handle tool) {
  if (!isLive(plugin, tool)) throw Refusal(C3DE_E_STALE, fmt::format("there is no tool of handle {}", textOf(tool)));
}

c3de_status C3DE_CALL add(void *ctx, const c3de_tool *tool, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "tools.add", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_tool in = tableOf(tool, "tool");
    registry::Tool made;
    made.owner = plugin.id();
    made.id = idOf(in.id, "tool id");
    made.label = labelOf(in.label, "tool label");
    made.hint = labelOf(in.hint, "tool hint");
    if (made.label.empty()) throw Refusal(C3DE_E_ARG, fmt::format("{}: label is empty", made.id));
    made.shortcut = in.shortcut;
    const bool isKey = (in.shortcut >= 'A' && in.shortcut <= 'Z') || (in.shortcut >= '0' && in.shortcut <= '9');
    if (in.shortcut != 0 && !isKey)
      throw Refusal(C3DE_E_ARG, fmt::format("{}: shortcut is {}, accepted: 0 (none), 'A' to 'Z', '0' to '9'", made.id,
                                            in.shortcut));
    if ((in.flags & ~C3DE_TOOL_IN_SLICES) != 0)
      throw Refusal(C3DE_E_UNSUPPORTED, fmt::format("{}: flags are {}, accepted: 0, {} (C3DE_TOOL_IN_SLICES)", made.id,
                                                    in.flags, C3DE_TOOL_IN_SLICES));
    made.inSlices = (in.flags & C3DE_TOOL_IN_SLICES) != 0;
    for (const registry::ToolRegistry::Entry &other : plugin.services().tools->tools())
      if (other.tool->id == made.id)
        throw Refusal(C3DE_E_EXISTS,
                      fmt::format("tool {} is registered by plugin {} already", made.id, other.tool->owner));
    auto callback = std::make_shared<ToolCallback>(plugin, in, made.label);
    made.self = callback.get();
    made.activate = &ToolCallback::activate;
    made.cancel = &ToolCallback::cancel;
    made.onEvent = &ToolCallback::onEvent;
    const Handle handle = plugin.services().tools->add(std::move(made));
    plugin.tools[handle.bits()] = std::move(callback);
    writeHandle(out, handle);
  });
}

c3de_status C3DE_CALL removeTool(void *ctx, c3de_handle tool) noexcept {
  return serveOnMain(ctx, "tools.remove", [&](PluginContext &plugin) {
    if (!plugin.tools.contains(tool.v))
      throw Refusal(C3DE_E_STALE, fmt::format("plugin {} has no tool of handle {}", plugin.id(), textOf(tool)));
    plugin.services().tools->remove(handleOf(tool));
    plugin.tools.erase(tool.v);
  });
}

c3de_status C3DE_CALL activate(void *ctx, c3de_handle tool) noexcept {
  return serveOnMain(ctx, "tools.activate", [&](PluginContext &plugin) {
    if (tool.v != 0) requireLive(plugin, tool);
    if (!plugin.services().tools->activate(handleOf(tool))) {
      const std::string reason = takeLastError();
      throw Refusal(C3DE_E_STATE, reason.empty() ? "the tool refused to become active" : reason);
    }
  });
}

c3de_status C3DE_CALL isActive(void *ctx, c3de_handle tool, std::uint32_t *active) noexcept {
  return serveOnMain(ctx, "tools.is_active", [&](PluginContext &plugin) {
    requireNonNull(active, "active");
    requireLive(plugin, tool);
    *active = plugin.services().tools->active() == handleOf(tool) ? 1u : 0u;
  });
}

c3de_status C3DE_CALL markedPoint(void *ctx, double *out) noexcept {
  return serveOnMain(ctx, "tools.marked_point", [&](PluginContext &plugin) {
    requireNonNull(out, "out");
    const auto point = plugin.services().tools->markedPoint();
    if (!point) throw Refusal(C3DE_E_UNSUPPORTED, "there are no views in which a point could be marked");
    std::copy(point->begin(), point->end(), out);
  });
}

}  // namespace

c3de_tools_v1 makeToolsTable(PluginContext *plugin) {
  return {sizeof(c3de_tools_v1), kToolsRevision, plugin, &add, &removeTool, &activate, &isActive, &markedPoint};
}

}  // namespace c3de::plugin_host
