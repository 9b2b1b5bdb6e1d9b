// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/session.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <set>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/scene/force_fields.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/plugin_parameters.h"
#include "c3de/session/recorder.h"
#include "c3de/session/resources.h"
#include "c3de/session/session_file.h"
#include "loading/fitted_scene.h"
#include "loading/scene_loader.h"

namespace c3de::session {
namespace {

std::string listOf(const std::vector<std::filesystem::path> &paths) {
  std::string text;
  for (const auto &path : paths) text += (text.empty() ? "" : ", ") + path.string();
  return text.empty() ? "none" : text;
}

}  // namespace

/// The program's own simulator is the default where others are installed and none is chosen.
static constexpr const char *kOwnSimulator = "c3de.pointbased.WorldSimulator/1";

namespace {

/// Who records a simulation. Any thread.
class RecorderSlot {
 public:
  void set(RecorderUse use, std::shared_ptr<Recorder> recorder) {
    const std::lock_guard lock(mutex_);
    recorders_[static_cast<std::size_t>(use)] = std::move(recorder);
  }
  [[nodiscard]] std::array<std::shared_ptr<Recorder>, 2> all() const {
    const std::lock_guard lock(mutex_);
    return recorders_;
  }
  template <class Add>
  void forEach(const Add &add) const {
    for (const auto &recorder : all())
      if (recorder) add(*recorder);
  }

 private:
  mutable std::mutex mutex_;
  std::array<std::shared_ptr<Recorder>, 2> recorders_;  ///< by RecorderUse
};

}  // namespace

struct Session::Impl {
  Impl(unsigned threads, bool hasWindow) : pool(threads, hasWindow), jobs(mainQueue) {}

  ThreadPool pool;
  MainQueue mainQueue;
  BackgroundJobs jobs;
  scene::SceneGraph sceneGraph;
  scene::MeshStore meshes;
  scene::ImageStore images;
  scene::SimulationDirectory simulations;
  scene::ForceFields forces;
  geometry::MeshFormats meshFormats;
  registry::ParameterRegistry parameters;  ///< without a window
  registry::SettingsStore settings{registry::defaultSettingsFolder()};
  scene::MaterialLibrary materials;
  std::vector<std::filesystem::path> folders;
  std::function<void(const scene::Simulation &)> publishedHook;
  registry::PanelRegistry *panels = nullptr;      ///< null: there is no window
  std::string simulatorClass;                     ///< where a scene does not specify one
  std::unique_ptr<plugin_host::PluginHost> host;  ///< destroyed before everything that plugins access
  std::shared_ptr<scene::Simulation> simulation;
  Handle node;
  std::shared_ptr<ChangeLog> changes;       ///< of the present simulation
  std::shared_ptr<RecorderSlot> recording;  ///< same
  std::set<std::shared_ptr<const void>> usedFiles;

  [[nodiscard]] SceneLoader::Services loading() { return {*host, meshes, meshFormats, materials}; }
  void release(std::shared_ptr<scene::Simulation> gone, Handle goneNode);
  [[nodiscard]] Handle addNode(const std::string &title);
  /// Lets plugins access it, act before its steps and be notified after them.
  [[nodiscard]] std::shared_ptr<RecorderSlot> connect(Handle at, const std::string &title,
                                                      const std::shared_ptr<scene::Simulation> &to);
};

/// Ends a simulation that has been detached from its node.
void Session::Impl::release(std::shared_ptr<scene::Simulation> gone, Handle goneNode) {
  if (!gone) return;
  gone->setPublishedListener({});
  simulations.remove(goneNode);
  gone.reset();
  sceneGraph.remove(goneNode);
}

Session::Session(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Session::~Session() {
  // The program's jobs use simulators, simulators are plugin code, and plugins use everything else.
  impl_->jobs.finishOwnedBy(kJobOwner);
  if (impl_->simulation) impl_->simulation->table()->attach(impl_->simulation->object(), c3de_handle{0});
  impl_->changes.reset();
  impl_->recording.reset();
  impl_->release(std::move(impl_->simulation), impl_->node);
  impl_->host.reset();
}

Expected<std::unique_ptr<Session>> Session::create(const SessionOptions &options) {
  auto impl = std::make_unique<Impl>(options.threads, options.panels != nullptr);

  if (auto materials = loadMaterialPresets(); materials)
    impl->materials = std::move(*materials);
  else
    log(LogLevel::warn, "no material presets: " + materials.error().message);

  plugin_host::Services services;
  services.pool = &impl->pool;
  services.mainQueue = &impl->mainQueue;
  services.jobs = &impl->jobs;
  services.sceneGraph = &impl->sceneGraph;
  services.meshes = &impl->meshes;
  services.images = &impl->images;
  services.simulations = &impl->simulations;
  services.forces = &impl->forces;
  services.renderer = options.renderer;
  services.panels = impl->panels = options.panels;
  services.parameters = options.parameters != nullptr ? options.parameters : &impl->parameters;
  services.tools = options.tools;
  services.edits = options.edits;
  services.commands = options.commands;
  services.meshFormats = &impl->meshFormats;
  services.settings = &impl->settings;
  impl->host = std::make_unique<plugin_host::PluginHost>(services, options.loadRules);
  std::unique_ptr<Session> session(new Session(std::move(impl)));
  // Named plugins first, so that they take precedence over those in the folders.
  plugin_host::PluginHost &host = *session->impl_->host;
  for (const auto &file : options.pluginFiles)
    if (const auto loaded = host.load(file); !loaded) return fail(ErrorCode::plugin, loaded.error().message);
  auto &folders = session->impl_->folders;
  if (options.searchPlugins) {
    for (const auto &folder : options.pluginFolders) {
      std::error_code code;
      if (!std::filesystem::is_directory(folder, code))
        return fail(ErrorCode::plugin, "--plugin-path " + notAFolder(folder));
      folders.push_back(folder);
    }
    for (const auto &folder : plugin_host::defaultPluginFolders()) folders.push_back(folder);
    for (const auto &folder : folders) host.loadFolder(folder);
  }
  host.start();
  // A named plugin may load and then fail to start.
  for (const plugin_host::PluginInfo &plugin : host.plugins())
    for (const auto &file : options.pluginFiles) {
      std::error_code code;
      if (plugin.state != plugin_host::PluginState::loaded && std::filesystem::equivalent(file, plugin.path, code))
        return fail(ErrorCode::plugin, "plugin " + plugin.path.string() + " " + plugin_host::stateName(plugin.state) +
                                           ": " + plugin.reason);
    }
  for (const std::string &assignment : options.pluginParameters)
    if (auto set = setPluginParameter(*services.parameters, host.plugins(), assignment); !set)
      return tl::unexpected(set.error());
  return session;
}

ThreadPool &Session::pool() { return impl_->pool; }
scene::ForceFields &Session::forces() { return impl_->forces; }
MainQueue &Session::mainQueue() { return impl_->mainQueue; }
BackgroundJobs &Session::jobs() { return impl_->jobs; }
scene::SceneGraph &Session::sceneGraph() { return impl_->sceneGraph; }
scene::MeshStore &Session::meshes() { return impl_->meshes; }
geometry::MeshFormats &Session::meshFormats() { return impl_->meshFormats; }
scene::ImageStore &Session::images() { return impl_->images; }
plugin_host::PluginHost &Session::plugins() { return *impl_->host; }
const scene::MaterialLibrary &Session::materials() const { return impl_->materials; }
const std::vector<std::filesystem::path> &Session::pluginFolders() const { return impl_->folders; }
scene::Simulation *Session::simulation() { return impl_->simulation.get(); }
std::shared_ptr<ChangeLog> Session::changes() { return impl_->changes; }
void Session::keepInUse(const std::vector<FoundFile> &files) {
  for (const FoundFile &one : files)
    if (one.use) impl_->usedFiles.insert(one.use);
}

std::vector<std::shared_ptr<Recorder>> Session::recorders() const {
  std::vector<std::shared_ptr<Recorder>> present;
  if (!impl_->recording) return present;
  for (auto &recorder : impl_->recording->all())
    if (recorder) present.push_back(std::move(recorder));
  return present;
}

std::function<void(std::shared_ptr<Recorder>)> Session::recorderSetter(RecorderUse use) {
  return [slot = impl_->recording, changes = impl_->changes, use](const std::shared_ptr<Recorder> &recorder) {
    if (!slot) return;
    slot->set(use, recorder);
    bool isRecorded = false;
    slot->forEach([&isRecorded](const Recorder &) { isRecorded = true; });
    if (isRecorded)
      changes->setListener([recorders = slot->all()](const SimulationChange &change) {
        for (const auto &one : recorders)
          if (one) one->addChange(change);
      });
    else
      changes->setListener({});
  };
}

Handle Session::simulationNode() const { return impl_->node; }

void Session::setPublishedHook(std::function<void(const scene::Simulation &)> hook) {
  impl_->publishedHook = std::move(hook);
}

Expected<SimulatorIdentity> Session::chooseSimulator(const std::string &classId) const {
  const std::vector<std::string> ids = impl_->host->classesWith(C3DE_IFACE_SIMULATOR_ID);
  if (ids.empty())
    return fail(ErrorCode::plugin, "no plugin that simulates is loaded; folders searched: " + listOf(impl_->folders) +
                                       "; `c3de plugins` lists what was found and why it was refused");
  std::string list;
  for (const std::string &id : ids) list += (list.empty() ? "" : ", ") + id;
  std::string wanted = !classId.empty() ? classId : impl_->simulatorClass;
  if (wanted.empty() && ids.size() > 1 && std::find(ids.begin(), ids.end(), kOwnSimulator) != ids.end())
    wanted = kOwnSimulator;
  if (wanted.empty() && ids.size() > 1)
    return fail(ErrorCode::plugin, "several classes simulate: " + list +
                                       "; choose one with [simulator] class = \"…\" in the scene, --set "
                                       "simulator.class=…, or in the window under Simulation");
  const std::string &chosen = wanted.empty() ? ids.front() : wanted;
  if (std::find(ids.begin(), ids.end(), chosen) == ids.end())
    return fail(ErrorCode::plugin, "no loaded plugin offers the simulator class '" + chosen + "'; there are: " + list);
  SimulatorIdentity identity{chosen, {}, {}, {}};
  for (const plugin_host::ClassInfo &info : impl_->host->classes())
    if (info.id == chosen) {
      identity.label = info.label;
      identity.plugin = info.plugin;
    }
  for (const plugin_host::PluginInfo &plugin : impl_->host->plugins())
    if (plugin.id == identity.plugin && plugin.state == plugin_host::PluginState::loaded)
      identity.version = plugin.version;
  return identity;
}

std::vector<SimulatorIdentity> Session::simulators() const {
  std::vector<SimulatorIdentity> all;
  for (const std::string &id : impl_->host->classesWith(C3DE_IFACE_SIMULATOR_ID))
    if (auto one = chooseSimulator(id)) all.push_back(std::move(*one));
  return all;
}

void Session::setSimulatorClass(const std::string &classId) { impl_->simulatorClass = classId; }
const std::string &Session::simulatorClass() const { return impl_->simulatorClass; }

Expected<c3de_object *> Session::createSimulator(const std::string &classId) {
  const auto chosen = chooseSimulator(classId);
  if (!chosen) return tl::unexpected(chosen.error());
  return impl_->host->createObject(chosen->classId);
}

Expected<void> Session::checkValues(c3de_object *simulator, const scene::SceneFile &scene) {
  const auto fitted = fitScene(simulator, scene);
  if (!fitted) return tl::unexpected(fitted.error());
  return {};
}

Expected<void> Session::populate(c3de_object *simulator, const scene::SceneFile &scene, const ProgressFn &progress,
                                 Prepared *prepared, BodySources *sources) {
  Prepared unused;
  BodySources own;
  return SceneLoader(impl_->loading(), simulator, sources != nullptr ? *sources : own,
                     prepared != nullptr ? *prepared : unused, progress)
      .populate(scene);
}

Expected<void> Session::addBodies(c3de_object *simulator, const scene::SceneFile &scene, const ProgressFn &progress,
                                  Prepared *prepared) {
  Prepared unused;
  BodySources own;
  return SceneLoader(impl_->loading(), simulator, own, prepared != nullptr ? *prepared : unused, progress)
      .addBodies(scene);
}

Handle Session::Impl::addNode(const std::string &title) {
  const Handle added = sceneGraph.add({}, title);
  Mat4 worldFromSimulation = kIdentity4;
  for (std::size_t axis = 0; axis < 3; ++axis) worldFromSimulation[5 * axis] = scene::kMillimetresPerMetre;
  sceneGraph.find(added)->parentFromNode = worldFromSimulation;
  sceneGraph.touch();
  return added;
}

std::shared_ptr<RecorderSlot> Session::Impl::connect(Handle at, const std::string &title,
                                                     const std::shared_ptr<scene::Simulation> &to) {
  auto slot = std::make_shared<RecorderSlot>();
  to->setBeforeStep(
      [fields = &forces, at, object = to->object(), table = to->table()] { return fields->apply(at, object, table); });
  to->setAfterStep([all = &simulations, at, slot](const c3de_sim_status &status) {
    slot->forEach([](Recorder &recorder) { recorder.addStep(); });
    all->stepped(at, status);
  });
  to->setAfterReset([slot](const c3de_sim_status &before) {
    slot->forEach([&before](Recorder &recorder) { recorder.addReset(before.steps); });
  });
  simulations.add(at, title, to);
  return slot;
}

Expected<void> Session::adopt(c3de_object *simulator, const std::string &title, SimulationSource source) {
  return adopt(simulator, title, std::move(source), false);
}

Expected<void> Session::adoptForRun(c3de_object *simulator, const std::string &title, SimulationSource source) {
  return adopt(simulator, title, std::move(source), true);
}

Expected<void> Session::adopt(c3de_object *simulator, const std::string &title, SimulationSource source,
                              bool isSteppedByCaller) {
  // A simulator has one observer.
  if (impl_->simulation && impl_->simulation->object() == simulator) impl_->changes.reset();
  auto changes = ChangeLog::create(simulator, std::move(source));
  if (!changes) return tl::unexpected(changes.error());
  plugin_host::PluginHost *host = impl_->host.get();
  const auto takeError = [host] { return host->takeError(); };
  const char *owner = host->ownerOf(simulator);
  auto created = isSteppedByCaller ? scene::Simulation::createForCaller(simulator, takeError, owner)
                                   : scene::Simulation::create(simulator, takeError, owner);
  if (!created) return tl::unexpected(created.error());
  std::shared_ptr<scene::Simulation> next = std::move(*created);
  if (!isSteppedByCaller)
    next->setPublishedListener([queue = &impl_->mainQueue, hook = impl_->publishedHook, simulation = next.get()] {
      if (hook) hook(*simulation);
      queue->requestRedraw();
    });

  const Handle nextNode = impl_->addNode(title);
  auto recorder = impl_->connect(nextNode, title, next);

  const std::uint64_t messages = impl_->panels != nullptr ? impl_->panels->lastSerial() : 0;
  // The previous simulation releases its panels and proxies first, so that there are never two sets of them.
  if (impl_->simulation) impl_->simulation->table()->attach(impl_->simulation->object(), c3de_handle{0});
  const c3de_status code = next->table()->attach(simulator, c3de_handle{nextNode.bits()});
  if (code < 0) {
    const std::string text = host->takeError();
    next->table()->attach(simulator, c3de_handle{0});
    impl_->release(std::move(next), nextNode);
    if (impl_->simulation)
      impl_->simulation->table()->attach(impl_->simulation->object(), c3de_handle{impl_->node.bits()});
    return fail(ErrorCode::plugin,
                "the simulator could not be shown: " + (text.empty() ? "status " + std::to_string(code) : text));
  }
  impl_->changes = std::move(*changes);
  impl_->recording = std::move(recorder);
  impl_->release(std::exchange(impl_->simulation, std::move(next)), std::exchange(impl_->node, nextNode));
  if (impl_->panels != nullptr) impl_->panels->dismissAboutSimulation(messages);
  return {};
}

void Session::closeSimulation() {
  if (!impl_->simulation) return;
  impl_->simulation->table()->attach(impl_->simulation->object(), c3de_handle{0});
  impl_->changes.reset();
  impl_->recording.reset();
  impl_->release(std::exchange(impl_->simulation, nullptr), std::exchange(impl_->node, {}));
  if (impl_->panels != nullptr) impl_->panels->dismissAboutSimulation(impl_->panels->lastSerial());
}

}  // namespace c3de::session
