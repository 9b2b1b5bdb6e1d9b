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
#include "c3de/session/change_log.h"
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

/// Owner of the program's own background jobs; a session cancels and awaits them before it unloads the plugins.
inline constexpr const char *kJobOwner = "c3de";

class BodySources;
class Recorder;
struct FoundFile;
/// A simulation has at most one recorder of each.
enum class RecorderUse {
  file,  ///< that the user has asked for
  past   ///< for a report about a problem
};

struct SessionOptions {
  bool searchPlugins = true;                         ///< in folders; false: only the plugins in pluginFiles
  std::vector<std::filesystem::path> pluginFiles;    ///< --plugin: each must load, otherwise the session fails
  std::vector<std::filesystem::path> pluginFolders;  ///< --plugin-path, before the default folders
  plugin_host::LoadRules loadRules;                  ///< plugins to leave out, and to try before they run
  std::vector<std::string> pluginParameters;         ///< --plugin-param: "PLUGIN:ID=VALUE" each
  unsigned threads = 0;                              ///< 0: as many as the machine has
  // Null in a run without a window; the session then owns the parameters.
  render::Renderer *renderer = nullptr;
  registry::PanelRegistry *panels = nullptr;
  registry::ParameterRegistry *parameters = nullptr;
  registry::ToolRegistry *tools = nullptr;
  registry::EditList *edits = nullptr;
  registry::CommandRegistry *commands = nullptr;
};

/// Everything that a run of the program holds: services, plugins, the present simulation. The same with and without a
/// window. Main thread, unless stated otherwise.
class Session {
 public:
  /// Loads the plugins; refused plugins are logged, one line each.
  [[nodiscard]] static Expected<std::unique_ptr<Session>> create(const SessionOptions &options);
  ~Session();

  [[nodiscard]] ThreadPool &pool();
  /// Force fields of plugins, acting on the bodies of any running simulation.
  [[nodiscard]] scene::ForceFields &forces();
  [[nodiscard]] MainQueue &mainQueue();
  [[nodiscard]] BackgroundJobs &jobs();
  [[nodiscard]] scene::SceneGraph &sceneGraph();
  [[nodiscard]] scene::MeshStore &meshes();
  [[nodiscard]] scene::ImageStore &images();
  /// The formats that the program and its plugins read.
  [[nodiscard]] geometry::MeshFormats &meshFormats();
  [[nodiscard]] plugin_host::PluginHost &plugins();
  /// Presets that scenes may refer to; empty when the file could not be read (which is logged).
  [[nodiscard]] const scene::MaterialLibrary &materials() const;
  /// The searched plugin folders, in order.
  [[nodiscard]] const std::vector<std::filesystem::path> &pluginFolders() const;

  /// The present simulation and its scene node; null until one is adopted.
  [[nodiscard]] scene::Simulation *simulation();
  [[nodiscard]] Handle simulationNode() const;
  /// Called on the simulation's thread after each snapshot of a simulation that is adopted after this call.
  void setPublishedHook(std::function<void(const scene::Simulation &)> hook);

  /// The simulator class (iface.simulator) with this id; empty: the class of setSimulatorClass(), otherwise the only
  /// one. The error (ErrorCode::plugin) lists the available ones, or states that no plugin offers one and which folders
  /// were searched.
  [[nodiscard]] Expected<SimulatorIdentity> chooseSimulator(const std::string &classId) const;
  /// A new, empty simulator of the class that chooseSimulator() selects. The caller owns the reference.
  [[nodiscard]] Expected<c3de_object *> createSimulator(const std::string &classId = {});
  /// All simulator classes.
  [[nodiscard]] std::vector<SimulatorIdentity> simulators() const;
  /// The class used where a scene does not specify one; empty: the only one.
  void setSimulatorClass(const std::string &classId);
  [[nodiscard]] const std::string &simulatorClass() const;

  /// Fills a simulator from a scene: checks every key against the simulator's declarations (unknown keys are errors
  /// with file, line and the nearest known key), reads all meshes, then adds obstacles, bodies and probes. Every
  /// validation of a scene uses this function. After an error the simulator cannot be used; the present simulation is
  /// unchanged. Any thread.
  /// @param prepared  may be null; preparation times and coverage of the bodies are added
  /// @param sources   may be null; reads the images of the bodies and stores them for others
  [[nodiscard]] Expected<void> populate(c3de_object *simulator, const scene::SceneFile &scene,
                                        const ProgressFn &progress, Prepared *prepared = nullptr,
                                        BodySources *sources = nullptr);

  /// Adds the bodies of a scene, with their fixes and loads, to a simulator that otherwise stays as it is. Its initial
  /// state then includes these bodies. Errors and `prepared` as for populate(). Any thread.
  [[nodiscard]] Expected<void> addBodies(c3de_object *simulator, const scene::SceneFile &scene,
                                         const ProgressFn &progress, Prepared *prepared = nullptr);

  /// Only the checks of keys and values of populate(). Any thread.
  [[nodiscard]] Expected<void> checkValues(c3de_object *simulator, const scene::SceneFile &scene);

  /// Makes the simulator the present simulation, with its own scene node and its own thread; ends the previous one.
  /// @param source  what it was built from
  [[nodiscard]] Expected<void> adopt(c3de_object *simulator, const std::string &title, SimulationSource source = {});
  /// Same without a thread: the caller steps (Simulation::beginStep).
  [[nodiscard]] Expected<void> adoptForRun(c3de_object *simulator, const std::string &title,
                                           SimulationSource source = {});
  /// Of the present simulation; null until one is adopted.
  [[nodiscard]] std::shared_ptr<ChangeLog> changes();
  /// From now on the present simulation adds its changes, steps and resets to the recorder, until it ends; null: to
  /// none. Whoever loads a state or adds the bodies of a scene adds that. Call on the simulation's thread between two
  /// steps, or before it runs.
  void setRecorder(std::shared_ptr<Recorder> recorder) { recorderSetter()(std::move(recorder)); }
  /// The same as a function to call on the simulation's thread. Main thread.
  [[nodiscard]] std::function<void(std::shared_ptr<Recorder>)> recorderSetter(RecorderUse use = RecorderUse::file);
  /// Those of the present simulation. Any thread.
  [[nodiscard]] std::vector<std::shared_ptr<Recorder>> recorders() const;
  /// Files that have been extracted stay until the session ends: undo and a return may build what uses them. Main
  /// thread.
  void keepInUse(const std::vector<FoundFile> &files);
  /// Ends the present simulation: its thread, its node, messages about it. No effect without one. Main thread.
  void closeSimulation();

 private:
  [[nodiscard]] Expected<void> adopt(c3de_object *simulator, const std::string &title, SimulationSource source,
                                     bool isSteppedByCaller);
  struct Impl;
  explicit Session(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::session
