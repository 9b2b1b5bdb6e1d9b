// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/core/text.h"
#include "c3de/registry/settings_store.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

Refusal nothingSet(const std::string &key) { return {C3DE_E_NOT_FOUND, fmt::format("nothing is set as '{}'", key)}; }

c3de_status C3DE_CALL get(void *ctx, c3de_str key, c3de_sink value) noexcept {
  return serve(ctx, "settings.get", [&](PluginContext &plugin) {
    const std::string name = idOf(key, "key");
    requireNonNull(value.put, "sink");
    const auto found = plugin.services().settings->get(plugin.id(), name);
    if (!found) throw nothingSet(name);
    return value.put(value.self, found->data(), found->size());
  });
}

c3de_status C3DE_CALL set(void *ctx, c3de_str key, c3de_str value) noexcept {
  return serve(ctx, "settings.set", [&](PluginContext &plugin) {
    orRefuse(plugin.services().settings->set(plugin.id(), idOf(key, "key"), textOf(value, "value")));
  });
}

c3de_status C3DE_CALL removeKey(void *ctx, c3de_str key) noexcept {
  return serve(ctx, "settings.remove", [&](PluginContext &plugin) {
    const std::string name = idOf(key, "key");
    if (!orRefuse(plugin.services().settings->remove(plugin.id(), name))) throw nothingSet(name);
  });
}

c3de_status C3DE_CALL keys(void *ctx, void *self, c3de_status(C3DE_CALL *each)(void *self, c3de_str key)) noexcept {
  return serve(ctx, "settings.keys", [&](PluginContext &plugin) -> c3de_status {
    requireNonNull(each, "each");
    for (const std::string &key : plugin.services().settings->keys(plugin.id()))
      if (const c3de_status status = each(self, toAbi(key)); status != C3DE_OK) return status;
    return C3DE_OK;
  });
}

}  // namespace

c3de_settings_v1 makeSettingsTable(PluginContext *plugin) {
  return {sizeof(c3de_settings_v1), kServiceRevision, plugin, &get, &set, &removeKey, &keys};
}

}  // namespace c3de::plugin_host
