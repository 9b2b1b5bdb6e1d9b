// SPDX-License-Identifier: Apache-2.0
// A program that loads the given plugins and draws their panels once: for plugins that end their program.
#include <cstdio>

#include "c3de/core/main_queue.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/text_panel.h"

int main(int argc, char **argv) {
  c3de::MainQueue mainQueue;
  c3de::registry::PanelRegistry panels;
  c3de::plugin_host::Services services;
  services.mainQueue = &mainQueue;
  services.panels = &panels;
  {
    c3de::plugin_host::PluginHost host(services);
    for (int i = 1; i < argc; ++i) (void)host.load(argv[i]);
    host.start();
    c3de::registry::TextPanel text(nullptr);
    for (const auto *panel : panels.panels()) std::puts(text.draw(*panel).c_str());
  }
  std::puts("came to its end");
  return 0;
}
