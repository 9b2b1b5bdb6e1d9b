// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "app.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"

namespace c3de::app {

/// Asks about each plugin that has crashed a run since the user was last asked. Adds the answers to the rules and the
/// records, before the plugins are loaded.
void askAboutCrashes(ui::WorkstationWindow &window, render::Renderer &renderer, plugin_host::LoadRules &rules);

/// Entries for the plugin manager.
/// @param offAtStart  ids, as of PluginRecords::allOff()
[[nodiscard]] std::vector<ui::PluginEntry> pluginEntries(const plugin_host::PluginHost &host,
                                                         const plugin_host::PluginRecords &records,
                                                         const std::vector<std::string> &offAtStart);

}  // namespace c3de::app
