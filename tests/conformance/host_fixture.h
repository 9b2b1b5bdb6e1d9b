// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/platform.h"
#include "c3de/core/thread_pool.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/mesh_store.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/scene/simulation_directory.h"
#include "support/catch.h"

namespace c3de::test {

/// A host with everything that a run with a window has, drawn by the null renderer; and the lines that were logged.
class HostFixture {
 public:
  explicit HostFixture(bool headless = false) {
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
    services.images = &images;
    services.simulations = &simulations;
    services.forces = &forces;
    services.meshFormats = &meshFormats;
    services.settings = &settings;
    if (!headless) {
      services.renderer = renderer.get();
      services.panels = &panels;
      services.parameters = &parameters;
      services.tools = &tools;
      services.edits = &edits;
      services.commands = &commands;
    }
    host = std::make_unique<plugin_host::PluginHost>(services);
  }
  ~HostFixture() {
    host.reset();
    setLogListener({});
    setLogThreshold(LogLevel::info);
    std::error_code ignored;
    std::filesystem::remove_all(settingsFolder, ignored);
  }

  static std::filesystem::path testPlugin(const std::string &name) {
    return std::filesystem::path(C3DE_TEST_PLUGINS) / (name + pluginExtension());
  }
  static std::filesystem::path hello() {
    return std::filesystem::path(testExampleFolder()) / (std::string("hello") + pluginExtension());
  }

  /// Lines that contain the text.
  std::vector<std::string> linesWith(const std::string &text) const {
    const std::lock_guard lock(linesMutex_);
    std::vector<std::string> out;
    for (const auto &[level, line] : lines_)
      if (line.find(text) != std::string::npos) out.push_back(line);
    return out;
  }
  std::size_t warnings() const {
    const std::lock_guard lock(linesMutex_);
    std::size_t n = 0;
    for (const auto &[level, line] : lines_) n += level == LogLevel::warn ? 1u : 0u;
    return n;
  }
  /// The handle in the line "made WHAT HANDLE" of a test plugin; null when it did not come so far.
  Handle madeBy(const std::string &what) const {
    for (const std::string &line : linesWith("made " + what + " ")) {
      const auto number = line.rfind(' ');
      return Handle::fromBits(std::stoull(line.substr(number + 1)));
    }
    return {};
  }

  /// Loads and starts; why the plugin was refused, empty when it was not.
  std::string refusalOf(const std::filesystem::path &file) {
    (void)host->load(file);
    host->start();
    const plugin_host::PluginInfo &info = host->plugins().back();
    return info.state == plugin_host::PluginState::refused ? info.reason : std::string();
  }
  bool nothingIsRegistered() {
    return host->classes().empty() && panels.panels().empty() && tools.tools().empty() && tools.active().isNull() &&
           commands.commands().empty() && meshFormats.readers().empty() && sceneGraph.rows().empty() &&
           jobs.running().empty();
  }

  ThreadPool pool{2};
  MainQueue mainQueue;
  BackgroundJobs jobs{mainQueue};
  scene::SceneGraph sceneGraph;
  scene::MeshStore meshes;
  scene::ImageStore images;
  scene::SimulationDirectory simulations;
  scene::ForceFields forces;
  std::unique_ptr<render::Renderer> renderer = render::createNullRenderer();
  registry::PanelRegistry panels;
  registry::ParameterRegistry parameters;
  registry::ToolRegistry tools;
  registry::EditList edits;
  registry::CommandRegistry commands;
  geometry::MeshFormats meshFormats;
  std::filesystem::path settingsFolder = freshSettingsFolder();
  registry::SettingsStore settings{settingsFolder};
  plugin_host::Services services;
  std::unique_ptr<plugin_host::PluginHost> host;

 private:
  static std::filesystem::path freshSettingsFolder() {
    static std::atomic<int> count{0};
    const auto folder = std::filesystem::path(testOutputRoot()) /
                        ("settings-" + std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) +
                         "-" + std::to_string(++count));
    std::filesystem::remove_all(folder);
    return folder;
  }
  mutable std::mutex linesMutex_;
  std::vector<std::pair<LogLevel, std::string>> lines_;
};

}  // namespace c3de::test
