// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/scene/simulation_directory.h"
#include "services/callbacks.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

c3de_status C3DE_CALL add(void *ctx, const c3de_panel *panel, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "panels.add", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_panel in = tableOf(panel, "panel");
    registry::Panel made;
    made.owner = plugin.id();
    made.id = idOf(in.id, "panel id");
    made.title = labelOf(in.title, "panel title");
    if (made.title.empty()) throw Refusal(C3DE_E_ARG, fmt::format("{}: title is empty", made.id));
    for (const registry::Panel *other : plugin.services().panels->panels())
      if (other->id == made.id)
        throw Refusal(C3DE_E_EXISTS, fmt::format("panel {} is registered by plugin {} already", made.id, other->owner));
    auto callback = std::make_shared<PanelCallback>(plugin, in, made.title);
    made.self = callback.get();
    made.onUi = &PanelCallback::onUi;
    const Handle handle = plugin.services().panels->add(std::move(made));
    plugin.panels[handle.bits()] = std::move(callback);
    writeHandle(out, handle);
  });
}

c3de_status C3DE_CALL removePanel(void *ctx, c3de_handle panel) noexcept {
  return serveOnMain(ctx, "panels.remove", [&](PluginContext &plugin) {
    const auto found = plugin.panels.find(panel.v);
    if (found == plugin.panels.end())
      throw Refusal(C3DE_E_STALE, fmt::format("plugin {} has no panel of handle {}", plugin.id(), textOf(panel)));
    plugin.services().panels->remove(handleOf(panel));
    plugin.panels.erase(found);
  });
}

c3de_status C3DE_CALL notify(void *ctx, std::uint32_t severity, c3de_str title, c3de_str text) noexcept {
  return serveOnMain(ctx, "panels.notify", [&](PluginContext &plugin) {
    if (severity > C3DE_LOG_ERROR)
      throw Refusal(C3DE_E_ARG, fmt::format("severity is {}, accepted: 0 (debug) to 3 (error)", severity));
    std::string heading = labelOf(title, "title");
    if (heading.empty()) heading = plugin.id();
    const scene::SimulationDirectory *simulations = plugin.services().simulations;
    const bool isOfSimulation = simulations != nullptr && !simulations->all().empty();
    plugin.services().panels->notify(severity, std::move(heading), labelOf(text, "text", Lines::many), {},
                                     isOfSimulation ? registry::About::simulation : registry::About::program);
  });
}

}  // namespace

c3de_panels_v1 makePanelsTable(PluginContext *plugin) {
  return {sizeof(c3de_panels_v1), kServiceRevision, plugin, &add, &removePanel, &notify};
}

}  // namespace c3de::plugin_host
