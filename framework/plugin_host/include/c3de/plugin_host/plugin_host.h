// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/abi/object.h"
#include "c3de/core/expected.h"
#include "c3de/core/foreign_call.h"
#include "c3de/plugin_host/load_rules.h"
#include "c3de/plugin_host/plugin_error.h"

namespace c3de {
class BackgroundJobs;
class MainQueue;
class ThreadPool;
namespace geometry {
class MeshFormats;
}
namespace render {
class Renderer;
}
namespace scene {
class ForceFields;
class ImageStore;
class MeshStore;
class SceneGraph;
class SimulationDirectory;
}  // namespace scene
namespace registry {
class CommandRegistry;
class EditList;
class PanelRegistry;
class ParameterRegistry;
class SettingsStore;
class ToolRegistry;
}  // namespace registry
}  // namespace c3de

namespace c3de::plugin_host {

/// What plugins may reach. Null members are not served in this run, for example `renderer`, `panels` and `tools`
/// without a window; get_service then answers C3DE_E_UNSUPPORTED. Must outlive the host.
struct Services {
  ThreadPool *pool = nullptr;
  MainQueue *mainQueue = nullptr;
  BackgroundJobs *jobs = nullptr;
  scene::SceneGraph *sceneGraph = nullptr;
  scene::MeshStore *meshes = nullptr;
  geometry::MeshFormats *meshFormats = nullptr;
  scene::ImageStore *images = nullptr;
  scene::SimulationDirectory *simulations = nullptr;
  scene::ForceFields *forces = nullptr;
  render::Renderer *renderer = nullptr;
  registry::PanelRegistry *panels = nullptr;
  registry::ParameterRegistry *parameters = nullptr;
  registry::ToolRegistry *tools = nullptr;
  registry::EditList *edits = nullptr;
  registry::CommandRegistry *commands = nullptr;
  registry::SettingsStore *settings = nullptr;
  /// How long a call of a plugin may take until people are told.
  CallWatchdog::Limits callLimits;
};

enum class PluginState {
  loaded,
  refused,   ///< it, or we, found that it cannot be used
  shadowed,  ///< another file with the same id is loaded already
  off        ///< somebody does not want it
};

/// "loaded", as the program writes it.
[[nodiscard]] const char *stateName(PluginState state);

struct PluginInfo {
  std::filesystem::path path;
  PluginState state = PluginState::refused;
  std::string reason;  ///< why not loaded, one line: what, both numbers or names, what to do
  std::string id, version, displayName, vendor, license;
  std::vector<std::string> classes;  ///< ids it has registered
};

struct ClassInfo {
  std::string id, label, doc, plugin;  ///< the plugin's id
  std::vector<std::string> interfaces;
};

/// Finds, loads, negotiates with and calls plugins. A plugin that fails on the way leaves nothing registered. Main
/// thread, except where plugins call services that say otherwise.
class PluginHost {
 public:
  explicit PluginHost(const Services &services, const LoadRules &rules = {});
  ~PluginHost();  ///< stops and destroys the plugins, last loaded first

  /// Loads one plugin: query, create. The error is one line, also kept in plugins().
  Expected<void> load(const std::filesystem::path &file);
  /// Every plugin of a folder in the order of their names; an id that is loaded already is reported as shadowed,
  /// what is switched off stays out, and a file that load() was given is not looked at again.
  void loadFolder(const std::filesystem::path &folder);
  /// Calls start() of what was loaded since the last call; a plugin that fails here is rolled back, too. Says in the
  /// log which names of LoadRules::without nothing had.
  void start();

  /// Carries transforms and visibility of scene nodes over to what plugins draw under them, and drops what hangs on
  /// removed nodes. The main queue does so at the start of every frame; for a picture without a frame.
  void syncScene();

  [[nodiscard]] const std::vector<PluginInfo> &plugins() const;
  [[nodiscard]] std::vector<ClassInfo> classes() const;
  /// Whether a plugin that is loaded has asked for a service, "c3de.imaging/1".
  [[nodiscard]] bool isUsed(const std::string &serviceId) const;
  /// Ids of the classes that list an interface.
  [[nodiscard]] std::vector<std::string> classesWith(const std::string &interfaceId) const;
  /// A new object with a count of one.
  [[nodiscard]] Expected<c3de_object *> createObject(const std::string &classId);
  /// The id of the plugin that made an object, for messages; stays as long as the program.
  [[nodiscard]] const char *ownerOf(const c3de_object *object) const;
  /// The text that the last failing call on this thread left; empty when none.
  [[nodiscard]] std::string takeError();
  /// The same, with what it is about apart from the text.
  [[nodiscard]] PluginError takeErrorAt();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Where plugins are looked for, in order: C3DE_PLUGIN_PATH, the user's folder, beside the program
/// (../lib/c3de/plugins).
[[nodiscard]] std::vector<std::filesystem::path> defaultPluginFolders();

}  // namespace c3de::plugin_host
