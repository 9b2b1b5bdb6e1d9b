// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "arguments.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/text.h"
#include "c3de/registry/panel_registry.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

void showToPerson(PluginContext &plugin, std::uint32_t severity, const std::string &line) {
  const Services &services = plugin.services();
  if (!services.panels) return;
  registry::PanelRegistry *panels = services.panels;
  const auto show = [panels, severity, title = plugin.id(), line] { panels->notify(severity, title, line); };
  if (std::this_thread::get_id() == plugin.host().mainThread)
    show();
  else if (services.mainQueue)
    services.mainQueue->post(show);
}

void C3DE_CALL write(void *ctx, std::uint32_t severity, c3de_str message) noexcept {
  (void)serve(ctx, "log.write", [&](PluginContext &plugin) {
    const std::uint32_t known = std::min(severity, C3DE_LOG_ERROR);
    const std::string line = displayText(fromAbi(message).substr(0, kLongestText));
    static constexpr LogLevel kLevels[] = {LogLevel::debug, LogLevel::info, LogLevel::warn, LogLevel::error};
    log(kLevels[known], "[" + plugin.id() + "] " + line);
    if (known >= C3DE_LOG_WARN) showToPerson(plugin, known, line);
  });
}

}  // namespace

c3de_log_v1 makeLogTable(PluginContext *plugin) { return {sizeof(c3de_log_v1), kServiceRevision, plugin, &write}; }

}  // namespace c3de::plugin_host
