// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/abi/object.h"
#include "c3de/core/expected.h"
#include "c3de/core/plugin_call.h"
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

/// Services accessible to plugins. Null members are not provided in this run, for example `renderer`, `panels` and
/// `tools` without a window; get_service then returns C3DE_E_UNSUPPORTED. Must outlive the host.
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
  /// How long a call of a plugin may take before the user is informed.
  CallWatchdog::Limits callLimits;
};

enum class PluginState {
  loaded,
  refused,   ///< the plugin or the host found that it cannot be used
  shadowed,  ///< another file with the same id is already loaded
  off        ///< switched off by the user
};

/// "loaded", in the spelling of the program's output.
[[nodiscard]] const char *stateName(PluginState state);

struct PluginInfo {
  std::filesystem::path path;
  PluginState state = PluginState::refused;
  std::string reason;  ///< why it was not loaded, one line: the cause, both numbers or names, the remedy
  std::string id, version, displayName, vendor, license;
  std::vector<std::string> classes;  ///< ids of the registered classes
};

struct ClassInfo {
  std::string id, label, doc, plugin;  ///< plugin: its id
  std::vector<std::string> interfaces;
};

/// Finds, loads, negotiates with and calls plugins. A plugin that fails during loading leaves nothing registered. Main
/// thread, except where plugins call services that specify otherwise.
class PluginHost {
 public:
  explicit PluginHost(const Services &services, const LoadRules &rules = {});
  ~PluginHost();  ///< stops and destroys the plugins, last loaded first

  /// Loads one plugin: query, create. The error is one line, also stored in plugins().
  Expected<void> load(const std::filesystem::path &file);
  /// Loads every plugin of a folder in the order of their names. An id that is already loaded is reported as shadowed.
  /// Plugins that are switched off are not loaded, and files already passed to load() are skipped.
  void loadFolder(const std::filesystem::path &folder);
  /// Calls start() of the plugins loaded since the last call; a plugin that fails here is also rolled back. Logs the
  /// names of LoadRules::without that matched nothing.
  void start();

  /// Applies transforms and visibility of scene nodes to what plugins draw under them, and removes what belongs to
  /// removed nodes. The main queue does this at the start of every frame; call it for a picture without a frame.
  void syncScene();

  [[nodiscard]] const std::vector<PluginInfo> &plugins() const;
  [[nodiscard]] std::vector<ClassInfo> classes() const;
  /// Whether a loaded plugin has requested a service, "c3de.imaging/1".
  [[nodiscard]] bool isUsed(const std::string &serviceId) const;
  /// Ids of the classes that list an interface.
  [[nodiscard]] std::vector<std::string> classesWith(const std::string &interfaceId) const;
  /// A new object with a reference count of one.
  [[nodiscard]] Expected<c3de_object *> createObject(const std::string &classId);
  /// The id of the plugin that created an object, for messages; valid as long as the program runs.
  [[nodiscard]] const char *ownerOf(const c3de_object *object) const;
  /// The text of the last failed call on this thread; empty if there is none.
  [[nodiscard]] std::string takeError();
  /// Same, with the location separate from the text.
  [[nodiscard]] PluginError takeErrorAt();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Folders that are searched for plugins, in order: C3DE_PLUGIN_PATH, the user's folder, the folder of the program
/// (../lib/c3de/plugins).
[[nodiscard]] std::vector<std::filesystem::path> defaultPluginFolders();

}  // namespace c3de::plugin_host
