// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/plugin_host/plugin_records.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"

namespace c3de::app {

/// Plugins that crashed a run, were refused or are off, and what the user decides about them. Main thread.
class PluginProblems {
 public:
  /// Asks about each plugin that has crashed a run since the user was last asked. Adds the answers to the rules and the
  /// records, before the plugins are loaded.
  PluginProblems(ui::WorkstationWindow &window, render::Renderer &renderer, plugin_host::LoadRules &rules);

  /// Reports the plugins that were refused.
  void report(const plugin_host::PluginHost &host, registry::PanelRegistry &panels) const;
  /// Adds the actions of the plugin manager.
  void connect(ui::WindowActions &actions, const plugin_host::PluginHost &host, ReportError failed);

 private:
  [[nodiscard]] std::vector<ui::PluginEntry> entries(const plugin_host::PluginHost &host) const;

  std::shared_ptr<plugin_host::PluginRecords> records_;
  std::vector<std::string> offAtStart_;  ///< ids
};

}  // namespace c3de::app
