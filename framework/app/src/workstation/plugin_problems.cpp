// SPDX-License-Identifier: Apache-2.0
#include "workstation/plugin_problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/file_path.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::app {
namespace {

constexpr const char *kWithout = "without", *kSafeMode = "safe_mode", *kLoad = "load";

/// Shortened for well-known folders.
std::string shownPath(const std::filesystem::path &file) {
  if (file.parent_path() == plugin_host::ownPluginFolder()) return pathText(file.filename()) + ", with the program";
  const std::filesystem::path home = homeDirectory();
  const std::filesystem::path below = home.empty() ? home : relativePath(file, home);
  return below.empty() || *below.begin() == ".." ? pathText(file) : "~/" + pathText(below);
}

ui::PluginEntry::State stateOf(plugin_host::PluginState state) {
  using From = plugin_host::PluginState;
  using To = ui::PluginEntry::State;
  switch (state) {
    case From::loaded: return To::loaded;
    case From::refused: break;
    case From::shadowed: return To::shadowed;
    case From::off: return To::off;
  }
  return To::refused;
}

/// Asks about each plugin that has crashed a run and is about to be loaded.
void askAboutCrashes(ui::WorkstationWindow &window, render::Renderer &renderer, plugin_host::LoadRules &rules) {
  if (!rules.records) return;
  for (const auto &crash : rules.records->crashes()) {
    const bool isOut = rules.isSafeMode || rules.records->isOff(crash.id) ||
                       std::find(rules.without.begin(), rules.without.end(), crash.id) != rules.without.end();
    if (crash.isAnswered || isOut || window.closeRequested()) continue;
    const std::string often =
        crash.count > 1 ? fmt::format("\n\nThis plugin has ended {} runs so far.", crash.count) : std::string();
    const std::string answer =
        window.ask({"crash",
                    "Go on without " + crash.id + "?",
                    "The last run " + crash.cause + "." + often +
                        "\n\nLeft out, it stays off until it is switched on in the plugin manager (menu Plugins). In "
                        "safe mode, this run loads only the plugins that came with the program.",
                    {{kWithout, "Without it"}, {kSafeMode, "Safe mode"}, {kLoad, "Load it"}}},
                   renderer);
    if (window.closeRequested()) return;  // asked again at the next start
    rules.records->answerCrash(crash.id);
    if (answer == kSafeMode) rules.isSafeMode = true;
    if (answer != kWithout) continue;
    if (const auto kept = rules.records->setOff(crash.id, true); !kept) {
      log(LogLevel::warn, kept.error().message);
      rules.without.push_back(crash.id);
    }
  }
}

}  // namespace

PluginProblems::PluginProblems(ui::WorkstationWindow &window, render::Renderer &renderer, plugin_host::LoadRules &rules)
    : records_(rules.records) {
  askAboutCrashes(window, renderer, rules);
  offAtStart_ = records_->allOff();
}

void PluginProblems::report(const plugin_host::PluginHost &host, registry::PanelRegistry &panels) const {
  for (const plugin_host::PluginInfo &plugin : host.plugins())
    if (plugin.state == plugin_host::PluginState::refused)
      panels.notify(C3DE_LOG_WARN, "Plugin " + pathText(plugin.path.filename()) + " was refused", plugin.reason);
}

void PluginProblems::connect(ui::WindowActions &actions, const plugin_host::PluginHost &host, ReportError failed) {
  actions.plugins = [this, &host] { return entries(host); };
  actions.switchPlugin = [this, failed = std::move(failed)](const std::string &id, bool isOn) {
    if (const auto kept = records_->setOff(id, !isOn); !kept)
      failed("The choice applies to this run only", kept.error());
  };
}

std::vector<ui::PluginEntry> PluginProblems::entries(const plugin_host::PluginHost &host) const {
  const auto crashes = records_->crashes();
  std::vector<ui::PluginEntry> entries;
  for (const plugin_host::PluginInfo &plugin : host.plugins()) {
    ui::PluginEntry entry{plugin.id,
                          !plugin.displayName.empty() ? plugin.displayName
                          : !plugin.id.empty()        ? plugin.id
                                                      : pathText(plugin.path.filename()),
                          plugin.version,
                          plugin.vendor,
                          plugin.license,
                          shownPath(plugin.path),
                          stateOf(plugin.state),
                          plugin.reason,
                          !records_->isOff(plugin.id)};
    const bool wasOff = std::find(offAtStart_.begin(), offAtStart_.end(), plugin.id) != offAtStart_.end();
    entry.hasChanged = wasOff == entry.isOn;
    const auto crash = std::find_if(crashes.begin(), crashes.end(), [&](const auto &one) {
      return one.id == plugin.id || one.id == pathText(plugin.path.filename());
    });
    if (crash != crashes.end()) {
      entry.crashes = crash->count;
      entry.lastCrash = crash->cause;
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace c3de::app
