// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
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

namespace c3de::validate {

/// A plugin host with all services of a run with a window, using the null renderer, and the logged lines. Only one at a
/// time.
class TrialHost {
 public:
  enum class Serves {
    all,
    headless,  ///< as in `c3de run`
    least      ///< only the services every host must have
  };
  using Change = std::function<void(plugin_host::Services &services)>;
  /// @param settingsFolder  its contents are removed at the end
  /// @param change  may remove services
  explicit TrialHost(std::filesystem::path settingsFolder, Serves serves = Serves::all, const Change &change = {});
  ~TrialHost();
  TrialHost(const TrialHost &) = delete;
  TrialHost &operator=(const TrialHost &) = delete;

  /// Lines that contain the text.
  [[nodiscard]] std::vector<std::string> linesWith(const std::string &text) const;
  /// Lines of this level and above.
  [[nodiscard]] std::vector<std::string> linesFrom(LogLevel least) const;

  /// Loads and starts a plugin. Returns why it is not loaded, empty if it is.
  [[nodiscard]] std::string refusalOf(const std::filesystem::path &file);
  /// What remains of removed plugins; empty if nothing.
  [[nodiscard]] std::string leftOver() const;

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
  std::filesystem::path settingsFolder;
  registry::SettingsStore settings{settingsFolder};
  plugin_host::Services services;
  std::unique_ptr<plugin_host::PluginHost> host;

 private:
  mutable std::mutex linesMutex_;
  std::vector<std::pair<LogLevel, std::string>> lines_;
};

}  // namespace c3de::validate
