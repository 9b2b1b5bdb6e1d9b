// SPDX-License-Identifier: Apache-2.0
#include "trial_host.h"

namespace c3de::validate {

TrialHost::TrialHost(std::filesystem::path folder, Serves serves, const Change &change)
    : settingsFolder(std::move(folder)) {
  setLogThreshold(LogLevel::error);
  setLogListener([this](LogLevel level, const std::string &line) {
    const std::lock_guard lock(linesMutex_);
    lines_.emplace_back(level, line);
  });
  services.pool = &pool;
  services.mainQueue = &mainQueue;
  services.jobs = &jobs;
  services.sceneGraph = &sceneGraph;
  services.meshes = &meshes;
  if (serves != Serves::least) {
    services.images = &images;
    services.simulations = &simulations;
    services.forces = &forces;
    services.meshFormats = &meshFormats;
    services.settings = &settings;
    services.parameters = &parameters;
  }
  if (serves == Serves::all) {
    services.renderer = renderer.get();
    services.panels = &panels;
    services.tools = &tools;
    services.edits = &edits;
    services.commands = &commands;
  }
  if (change) change(services);
  host = std::make_unique<plugin_host::PluginHost>(services);
}

TrialHost::~TrialHost() {
  host.reset();
  setLogListener({});
  setLogThreshold(LogLevel::info);
  std::error_code ignored;
  std::filesystem::remove_all(settingsFolder, ignored);
}

std::vector<std::string> TrialHost::linesWith(const std::string &text) const {
  const std::lock_guard lock(linesMutex_);
  std::vector<std::string> out;
  for (const auto &[level, line] : lines_)
    if (line.find(text) != std::string::npos) out.push_back(line);
  return out;
}

std::vector<std::string> TrialHost::linesFrom(LogLevel least) const {
  const std::lock_guard lock(linesMutex_);
  std::vector<std::string> out;
  for (const auto &[level, line] : lines_)
    if (level >= least) out.push_back(line);
  return out;
}

std::string TrialHost::refusalOf(const std::filesystem::path &file) {
  (void)host->load(file);
  host->start();
  const plugin_host::PluginInfo &info = host->plugins().back();
  return info.state == plugin_host::PluginState::loaded ? std::string() : info.reason;
}

std::string TrialHost::leftOver() const {
  std::string text;
  const auto add = [&](const char *what, bool isThere) {
    if (isThere) text += (text.empty() ? "" : ", ") + std::string(what);
  };
  auto &self = const_cast<TrialHost &>(*this);  // the lists have no const overloads
  add("classes", host && !host->classes().empty());
  add("panels", !self.panels.panels().empty());
  add("tools", !tools.tools().empty());
  add("an active tool", !tools.active().isNull());
  add("commands", !commands.commands().empty());
  add("mesh readers", !meshFormats.readers().empty());
  add("scene nodes", !self.sceneGraph.rows().empty());
  add("jobs", !self.jobs.running().empty());
  return text;
}

}  // namespace c3de::validate
