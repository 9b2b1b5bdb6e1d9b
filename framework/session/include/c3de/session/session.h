// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "c3de/core/background_jobs.h"
#include "c3de/core/expected.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/progress.h"
#include "c3de/core/thread_pool.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/mesh_store.h"
#include "c3de/scene/scene_file.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/scene/simulation.h"
#include "c3de/scene/simulation_directory.h"
#include "c3de/session/preparation.h"
#include "c3de/session/simulator_identity.h"

namespace c3de::registry {
class CommandRegistry;
class EditList;
class PanelRegistry;
class ParameterRegistry;
class ToolRegistry;
}  // namespace c3de::registry

namespace c3de::session {

/// Owner of the program's own background jobs; a session cancels and waits for them before the plugins go.
inline constexpr const char *kJobOwner = "c3de";

class BodySources;

struct SessionOptions {
  bool searchPlugins = true;                         ///< in folders; false: only those that pluginFiles names
  std::vector<std::filesystem::path> pluginFiles;    ///< --plugin: each must load, or the session fails
  std::vector<std::filesystem::path> pluginFolders;  ///< --plugin-path, before the default folders
  plugin_host::LoadRules loadRules;                  ///< what is left out, and tried before it runs
  std::vector<std::string> pluginParameters;         ///< --plugin-param: "PLUGIN:ID=VALUE" each
  unsigned threads = 0;                              ///< 0: as many as the machine has
  // Null in a run without a window; parameters are then those of the session itself.
  render::Renderer *renderer = nullptr;
  registry::PanelRegistry *panels = nullptr;
  registry::ParameterRegistry *parameters = nullptr;
  registry::ToolRegistry *tools = nullptr;
  registry::EditList *edits = nullptr;
  registry::CommandRegistry *commands = nullptr;
};

/// What a run of the program holds: services, plugins, the present simulation. The same with and without a window.
/// Main thread, except where it says otherwise.
class Session {
 public:
  /// Loads the plugins; those that are refused are logged, one line each.
  [[nodiscard]] static Expected<std::unique_ptr<Session>> create(const SessionOptions &options);
  ~Session();

  [[nodiscard]] ThreadPool &pool();
  /// Of plugins, on the bodies of whatever runs.
  [[nodiscard]] scene::ForceFields &forces();
  [[nodiscard]] MainQueue &mainQueue();
  [[nodiscard]] BackgroundJobs &jobs();
  [[nodiscard]] scene::SceneGraph &sceneGraph();
  [[nodiscard]] scene::MeshStore &meshes();
  [[nodiscard]] scene::ImageStore &images();
  /// What the program and its plugins read.
  [[nodiscard]] geometry::MeshFormats &meshFormats();
  [[nodiscard]] plugin_host::PluginHost &plugins();
  /// Presets that scenes may name; empty when the file could not be read (which is logged).
  [[nodiscard]] const scene::MaterialLibrary &materials() const;
  /// Where plugins were looked for, in order.
  [[nodiscard]] const std::vector<std::filesystem::path> &pluginFolders() const;

  /// The present simulation and its scene node; null until one is adopted.
  [[nodiscard]] scene::Simulation *simulation();
  [[nodiscard]] Handle simulationNode() const;
  /// Called on the simulation's thread after each snapshot of a simulation that is adopted from here on.
  void setPublishedHook(std::function<void(const scene::Simulation &)> hook);

  /// The class of an id that answers iface.simulator; empty: that of setSimulatorClass(), else the only one. The error
  /// (ErrorCode::plugin) lists those that there are, or says that no plugin offers one and which folders were searched.
  [[nodiscard]] Expected<SimulatorIdentity> chooseSimulator(const std::string &classId) const;
  /// A new, empty simulator of the class that chooseSimulator() gives. The caller has the count.
  [[nodiscard]] Expected<c3de_object *> createSimulator(const std::string &classId = {});
  /// Every class that simulates.
  [[nodiscard]] std::vector<SimulatorIdentity> simulators() const;
  /// What is taken where a scene does not say; empty: the only one.
  void setSimulatorClass(const std::string &classId);
  [[nodiscard]] const std::string &simulatorClass() const;

  /// Fills a simulator from a scene: checks every key against the simulator's declarations (unknown keys are errors
  /// with file, line and the nearest known key), reads all meshes, then adds obstacles, bodies and probes. Whatever
  /// says that a scene is good asks this. On an error the simulator is of no use; the present simulation is untouched.
  /// Any thread.
  /// @param prepared  null, or what the bodies took and stand for is added
  /// @param sources   null, or where the images of bodies are read and kept for others
  [[nodiscard]] Expected<void> populate(c3de_object *simulator, const scene::SceneFile &scene,
                                        const ProgressFn &progress, Prepared *prepared = nullptr,
                                        BodySources *sources = nullptr);

  /// Adds the bodies of a scene, with their fixes and loads, to a simulator that goes on with the rest as it is; its
  /// initial state is then the one that has them. Errors and `prepared` as of populate(). Any thread.
  [[nodiscard]] Expected<void> addBodies(c3de_object *simulator, const scene::SceneFile &scene,
                                         const ProgressFn &progress, Prepared *prepared = nullptr);

  /// Of populate() the checks of keys and values alone. Any thread.
  [[nodiscard]] Expected<void> checkValues(c3de_object *simulator, const scene::SceneFile &scene);

  /// Makes the simulator the present simulation: a scene node of its own, a thread of its own; the one before goes.
  [[nodiscard]] Expected<void> adopt(c3de_object *simulator, const std::string &title);
  /// The same without a thread: the caller steps (Simulation::beginStep).
  [[nodiscard]] Expected<void> adoptForRun(c3de_object *simulator, const std::string &title);
  /// Ends the present simulation: its thread, its node, messages about it. Nothing where there is none. Main thread.
  void closeSimulation();

 private:
  [[nodiscard]] Expected<void> adopt(c3de_object *simulator, const std::string &title, bool isDrivenByCaller);
  struct Impl;
  explicit Session(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::session
