// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/foreign_call.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/force_fields.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/plugin_parameters.h"
#include "c3de/session/resources.h"
#include "c3de/session/scene_to_abi.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/tissues.h"
#include "fitted_skins.h"

namespace c3de::session {
namespace {

constexpr double kFitReach = 1.5;  // voxels: skins lie within about half a voxel of the border, corners an edge

std::string listOf(const std::vector<std::filesystem::path> &paths) {
  std::string text;
  for (const auto &path : paths) text += (text.empty() ? "" : ", ") + path.string();
  return text.empty() ? "none" : text;
}

/// A scene whose every value has been checked.
struct FittedScene {
  std::vector<ParameterValue> world;
  std::vector<std::vector<ParameterValue>> bodies, obstacles;
  std::vector<std::vector<std::vector<ParameterValue>>> parts;  ///< per body and part
};

bool isRigid(const scene::SceneBody &body) {
  return std::any_of(body.params.begin(), body.params.end(), [](const scene::SceneValue &value) {
    return value.value.id == C3DE_PARAM_ID_RIGID && value.value.num != 0.0;
  });
}

// Bodies are handed over one after the other; the first one has to leave time for the others.
void sayHowManyShareBudget(const scene::SceneFile &scene, const std::vector<ParameterDecl> &declared,
                           std::vector<ParameterValue> &world) {
  const std::string id = C3DE_PARAM_ID_ACCURACY_BODIES;
  if (std::none_of(declared.begin(), declared.end(), [&](const ParameterDecl &d) { return d.id == id; })) return;
  if (std::any_of(world.begin(), world.end(), [&](const ParameterValue &v) { return v.id == id; })) return;
  ParameterValue bodies;
  bodies.id = id;
  bodies.type = C3DE_PARAM_I64;
  bodies.num = static_cast<double>(
      std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::SceneBody &b) { return !isRigid(b); }));
  bodies.num = std::max(1.0, bodies.num);
  world.push_back(std::move(bodies));
}

Expected<FittedScene> fitScene(c3de_object *simulator, const scene::SceneFile &scene) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (!servesFills(*table))
    for (const scene::SceneBody &body : scene.bodies)
      if (body.mesh.empty())
        return fail(ErrorCode::input, scene.where(body.line) + ": 'volume' is not served by this simulator");
  const auto contact = contactTable(simulator);
  if (!contact) return tl::unexpected(contact.error());
  for (const scene::SceneBody &body : scene.bodies)
    if (*contact == nullptr && !body.volume.slides.empty())
      return fail(ErrorCode::input, scene.where(body.line) + ": 'slides' is not served by this simulator");
  if (*contact == nullptr && !scene.contactPairs.empty())
    return fail(ErrorCode::input,
                scene.where(scene.contactPairs.front().line) + ": '[[contact.pair]]' is not served by this simulator");
  if ((*contact == nullptr || (*contact)->add_probe_tool == nullptr) && !scene.probeTools.empty())
    return fail(ErrorCode::input,
                scene.where(scene.probeTools.front().line) + ": '[[probe_tool]]' is not served by this simulator");
  const auto attachments = attachmentTable(simulator);
  if (!attachments) return tl::unexpected(attachments.error());
  if (*attachments == nullptr && !scene.attachments.empty())
    return fail(ErrorCode::input,
                scene.where(scene.attachments.front().line) + ": '[[attachment]]' is not served by this simulator");
  const auto grasps = graspTable(simulator);
  if (!grasps) return tl::unexpected(grasps.error());
  if (*grasps == nullptr && !scene.grasps.empty())
    return fail(ErrorCode::input,
                scene.where(scene.grasps.front().line) + ": '[[grasp]]' is not served by this simulator");
  const auto world = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD);
  if (!world) return tl::unexpected(world.error());
  const auto body = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_BODY);
  if (!body) return tl::unexpected(body.error());
  const auto obstacle = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_OBSTACLE);
  if (!obstacle) return tl::unexpected(obstacle.error());

  FittedScene fitted;
  auto values = scene::fitToDeclarations(scene, scene.world, *world);
  if (!values) return tl::unexpected(values.error());
  fitted.world = std::move(*values);
  sayHowManyShareBudget(scene, *world, fitted.world);
  for (const scene::SceneBody &one : scene.bodies) {
    values = scene::fitToDeclarations(scene, one.params, *body);
    if (!values) return tl::unexpected(values.error());
    fitted.bodies.push_back(std::move(*values));
    fitted.parts.emplace_back();
    for (const scene::ScenePart &part : one.parts) {
      values = scene::fitToDeclarations(scene, part.params, *body);
      if (!values) return tl::unexpected(values.error());
      fitted.parts.back().push_back(std::move(*values));
    }
  }
  for (const scene::SceneObstacle &one : scene.obstacles) {
    values = scene::fitToDeclarations(scene, one.params, *obstacle);
    if (!values) return tl::unexpected(values.error());
    fitted.obstacles.push_back(std::move(*values));
  }
  return fitted;
}

/// Shows the progress of one of several parts as a share of the whole, and hands it on through the C boundary.
class PartProgress {
 public:
  PartProgress(const ProgressFn &whole, std::string what, std::size_t index, std::size_t count)
      : whole_(whole), what_(std::move(what)), index_(static_cast<double>(index)),
        count_(static_cast<double>(std::max<std::size_t>(count, 1))) {
    abi_.size = sizeof abi_;
    abi_.self = this;
    abi_.update = [](void *self, double fraction, c3de_str text) -> c3de_status {
      // Nothing may be thrown through the boundary.
      try {
        return static_cast<PartProgress *>(self)->update(fraction, shownText(fromAbi(text))) ? C3DE_OK
                                                                                             : C3DE_E_CANCELLED;
      } catch (...) {
        return C3DE_E_EXCEPTION;
      }
    };
  }
  PartProgress(const PartProgress &) = delete;
  PartProgress &operator=(const PartProgress &) = delete;

  bool update(double fraction, const std::string &text) const {
    if (const ForeignCall *call = call_) call->noteProgress();
    if (!whole_) return true;
    const double part = fraction < 0.0 ? 0.0 : std::min(fraction, 1.0);
    return whole_((index_ + part) / count_, text.empty() ? what_ : what_ + ": " + text);
  }
  [[nodiscard]] const c3de_progress *abi() const { return &abi_; }

  /// Calls a function of a table that may take long, as long as it says that it goes on.
  template <class F>
  c3de_status call(const char *owner, const char *what, F &&f) {
    return callForeign(owner, what, CallKind::job, [&](const ForeignCall &recorded) {
      call_ = &recorded;
      struct AtEnd {
        PartProgress &part;
        ~AtEnd() { part.call_ = nullptr; }
      } const atEnd{*this};
      return f();
    });
  }

 private:
  const ProgressFn &whole_;
  std::string what_;
  double index_, count_;
  std::atomic<const ForeignCall *> call_{nullptr};
  c3de_progress abi_{};
};

Expected<BodyGeometry> meshOf(const scene::SceneBody &body, const geometry::MeshFormats &formats,
                              const ProgressFn &progress) {
  BodyGeometry loaded;
  {
    const TimeSpent reading(loaded.took.reading_s);
    const auto unit = formats.unitOf(body.mesh, body.meshUnit);
    if (!unit) return tl::unexpected(unit.error());
    auto mesh = formats.load(body.mesh, *unit, progress);
    if (!mesh) return tl::unexpected(mesh.error());
    loaded.skin = std::move(*mesh);
  }
  if (const auto fillable = geometry::checkFillable(loaded.skin.mesh, loaded.skin.report); !fillable)
    return tl::unexpected(fillable.error());
  return loaded;
}

/// @param values  of the body, checked
Expected<BodyGeometry> loadFromVolume(BodySources &sources, const scene::SceneBody &body,
                                      const std::vector<ParameterValue> &values, const ProgressFn &progress) {
  Preparation took;
  const auto picked = sources.pick(body.volume, progress, took);
  if (!picked) return tl::unexpected(picked.error());
  // As many points as the scene says, or as fit its spacing.
  double points = 1000.0;
  for (const ParameterValue &value : values) {
    if (value.id == C3DE_PARAM_ID_COUNT && value.num > 0.0) points = value.num;
    if (value.id == C3DE_PARAM_ID_SPACING && value.num > 0.0)
      points = imaging::volumeOf(picked->mask) / std::pow(value.num * scene::kMillimetresPerMetre, 3);
  }
  auto loaded = bodyGeometryOf(picked->mask, body.volume.edgeLength_mm, points, picked->tissues != nullptr, progress);
  if (!loaded) return loaded;
  if (picked->tissues) {
    if (const auto added = addTissues(body.volume, *picked->tissues, points, *loaded); !added)
      return tl::unexpected(added.error());
    auto places = sources.placesOf(body, *picked);
    if (!places) return tl::unexpected(places.error());
    loaded->places = std::make_shared<TissuePlaces>(std::move(*places));
    loaded->thickness_mm = thicknessOf(*picked->tissues, body.volume.tissues.size());
  }
  loaded->took += took;
  loaded->colour = picked->colour;
  return loaded;
}

/// The skins of pieces are fitted to each other, so all of a body are there before the first is built.
Expected<void> loadPieces(BodySources &sources, const scene::SceneFile &scene, const FittedScene &fitted,
                          const ProgressFn &progress, std::vector<std::optional<BodyGeometry>> &loaded) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto &cut = scene.bodies[i].volume.cut;
    if (!cut || scene.bodies[i].volume.piece != 0) continue;
    std::vector<geometry::TriangleMesh *> skins;
    for (std::size_t p = i; p < scene.bodies.size() && scene.bodies[p].volume.cut == cut; ++p) {
      const scene::SceneBody &body = scene.bodies[p];
      auto piece = loadFromVolume(sources, body, fitted.bodies[p], [&](double, const std::string &what) {
        return !progress || progress(0.0, body.name + ": " + what);
      });
      if (!piece) return failInScene(piece.error(), scene, body.line);
      loaded[p] = std::move(*piece);
      skins.push_back(&loaded[p]->skin.mesh);
    }
    const Vec3 edges = cut->tissues.geometry.spacing();
    if (auto good = fitSkins(skins, kFitReach * std::max({edges[0], edges[1], edges[2]})); !good)
      return failInScene(good.error(), scene, scene.bodies[i].line);
  }
  return {};
}

/// A piece whose count is a share of that of its body has the spacing of the rest, which pieces share by volume only
/// where they are large: points at skins are of little tissue. Small pieces have four spacings along a cube of theirs.
void sampleAsRest(const c3de_simulator_v1 *table, c3de_object *simulator, c3de_handle rest, double volume_mm3,
                  std::vector<ParameterValue> &values) {
  const auto count = std::find_if(values.begin(), values.end(), [](const ParameterValue &value) {
    return value.id == C3DE_PARAM_ID_COUNT && value.num > 0.0;
  });
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (count == values.end() || table->body_info(simulator, rest, &info) < 0 || !(info.spacing_m > 0.0)) return;
  count->id = C3DE_PARAM_ID_SPACING;
  count->type = C3DE_PARAM_F64;
  count->num = std::min(info.spacing_m, std::cbrt(volume_mm3) / (4.0 * scene::kMillimetresPerMetre));
}

/// That tissues are finer than the cells of their body.
void tellThin(const c3de_simulator_v1 *table, c3de_object *simulator, c3de_handle added, const scene::SceneBody &body,
              const BodyGeometry &geometry) {
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (geometry.thickness_mm.empty() || table->body_info(simulator, added, &info) < 0) return;
  const double spacing_mm = info.spacing_m * scene::kMillimetresPerMetre;
  constexpr std::size_t kMost = 6;
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < geometry.thickness_mm.size(); ++i) {
    const scene::SceneTissue &tissue = body.volume.tissues[i];
    const double thickness = body.placement.scale * geometry.thickness_mm[i];
    if (tissue.isRigid || tissue.isEmpty || !(thickness > 0.0 && thickness < spacing_mm)) continue;
    if (++count > kMost) continue;
    names += (names.empty() ? "" : ", ") + tissue.label;
  }
  if (count == 0) return;
  if (count > kMost) names += " and " + std::to_string(count - kMost) + " more";
  log(LogLevel::info, "body '" + body.name + "': thinner than the spacing of " +
                          formatNumber(std::round(10.0 * spacing_mm) / 10.0) + " mm: " + names +
                          "; cells hold such tissue beside what is around it, each by its volume, and move both alike");
}

/// Keeps a mesh in the store for the duration of a call.
class MeshLease {
 public:
  MeshLease(scene::MeshStore &store, geometry::LoadedMesh mesh) : store_(store), handle_(store.add(std::move(mesh))) {}
  ~MeshLease() { store_.remove(handle_); }
  MeshLease(const MeshLease &) = delete;
  MeshLease &operator=(const MeshLease &) = delete;
  [[nodiscard]] c3de_handle abi() const { return {handle_.bits()}; }

 private:
  scene::MeshStore &store_;
  Handle handle_;
};

/// What bodies and obstacles have in common; it points into what it is made of.
template <class Described>
Described toAbi(const std::string &name, const MeshLease &mesh, const c3de_sim_placement &placement,
                const std::vector<c3de_param_value> &params) {
  Described abi{};
  abi.size = sizeof abi;
  abi.params_stride = sizeof(c3de_param_value);
  abi.name = c3de::toAbi(name);
  abi.mesh = mesh.abi();
  abi.placement = &placement;
  abi.params = params.data();
  abi.params_n = params.size();
  return abi;
}

}  // namespace

namespace {

/// Of a scene whose tissues are settled: itself, or a copy.
Expected<const scene::SceneFile *> settled(c3de_object *simulator, const scene::SceneFile &asked,
                                           const scene::MaterialLibrary &materials, BodySources &sources,
                                           const ProgressFn &progress, Preparation &took, scene::SceneFile &copy) {
  const auto isUnsettled = [](const scene::SceneBody &body) {
    return body.volume.hasTissues() && !body.volume.isSettled;
  };
  if (std::none_of(asked.bodies.begin(), asked.bodies.end(), isUnsettled)) return &asked;
  // What is wrong with a key is not to be heard after a map has been read.
  if (const auto fitted = fitScene(simulator, asked); !fitted) return tl::unexpected(fitted.error());
  copy = asked;
  if (auto good = settleTissues(copy, materials, sources, progress, took); !good) return tl::unexpected(good.error());
  return &copy;
}

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
  registry::ParameterRegistry parameters;  ///< where there is no window
  registry::SettingsStore settings{registry::defaultSettingsFolder()};
  scene::MaterialLibrary materials;
  std::vector<std::filesystem::path> folders;
  std::function<void(const scene::Simulation &)> publishedHook;
  std::string simulatorClass;                     ///< where a scene does not say one
  std::unique_ptr<plugin_host::PluginHost> host;  ///< after everything that plugins reach
  std::shared_ptr<scene::Simulation> simulation;
  Handle node;

  /// Why the last call of a simulator failed.
  /// @param line  of the scene, unless the message speaks of a table of the body
  [[nodiscard]] Error lastError(c3de_status code, const scene::SceneFile &scene, int line, const std::string &what,
                                const scene::SceneBody *body = nullptr) const;
  [[nodiscard]] Expected<void> addTouch(c3de_object *simulator, const scene::SceneFile &scene,
                                        std::map<std::string, c3de_handle> named) const;
  void release(std::shared_ptr<scene::Simulation> gone, Handle goneNode);
  [[nodiscard]] Handle addNode(const std::string &title);
  /// Lets plugins reach it, act before its steps and be told after them.
  void connect(Handle at, const std::string &title, const std::shared_ptr<scene::Simulation> &to);
  [[nodiscard]] Expected<std::vector<c3de_handle>> addBodies(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                             const scene::SceneFile &scene, const FittedScene &fitted,
                                                             BodySources &sources, const ProgressFn &progress,
                                                             Prepared &prepared);
};

Error Session::Impl::lastError(c3de_status code, const scene::SceneFile &scene, int line, const std::string &what,
                               const scene::SceneBody *body) const {
  if (code == C3DE_E_CANCELLED) return {ErrorCode::cancelled, what + " was cancelled"};
  const plugin_host::PluginError error = host->takeErrorAt();
  if (body != nullptr) line = sceneLineOf(scene, *body, error).value_or(line);
  return {ErrorCode::input, scene.where(line) + ": " +
                                (error.text.empty() ? what + " failed (status " + std::to_string(code) + ")"
                                                    : plugin_host::describe(error))};
}

Expected<std::vector<c3de_handle>> Session::Impl::addBodies(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                            const scene::SceneFile &scene, const FittedScene &fitted,
                                                            BodySources &sources, const ProgressFn &progress,
                                                            Prepared &prepared) {
  // All meshes before the first body: what is wrong with the last of them is not to be heard after minutes of building.
  std::vector<std::optional<BodyGeometry>> meshed(scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const scene::SceneBody &body = scene.bodies[i];
    if (body.mesh.empty()) continue;
    auto read = meshOf(body, meshFormats, [&](double, const std::string &what) {
      return !progress || progress(0.0, body.name + ": " + what);
    });
    if (!read) return failInScene(read.error(), scene, body.line);
    meshed[i] = std::move(*read);
  }
  if (auto cut = loadPieces(sources, scene, fitted, progress, meshed); !cut) return tl::unexpected(cut.error());
  std::vector<c3de_handle> bodies;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const scene::SceneBody &body = scene.bodies[i];
    PartProgress partProgress(progress, body.name, i, scene.bodies.size());
    // Reading is a small share of what building a body takes.
    const ProgressFn reading = [&](double f, const std::string &what) {
      return partProgress.update(0.1 * std::max(f, 0.0), what);
    };
    Expected<BodyGeometry> source = meshed[i] ? Expected<BodyGeometry>(std::move(*meshed[i]))
                                              : loadFromVolume(sources, body, fitted.bodies[i], reading);
    if (!source) return failInScene(source.error(), scene, body.line);
    for (const std::string &notice : sources.takeNotices())
      log(LogLevel::warn, body.volume.file.string() + ": " + notice);
    prepared.took += source->took;
    if (body.mesh.empty()) {
      prepared.coverage.push_back(source->coverage);
      prepared.coverage.back().body = body.name;
      if (const std::string text = sentenceOf(prepared.coverage.back()); !text.empty()) log(LogLevel::warn, text);
    }
    const TimeSpent building(prepared.took.bodies_s);
    const MeshLease lease(meshes, std::move(source->skin));
    std::vector<ParameterValue> values = fitted.bodies[i];
    if (body.volume.piece != 0)
      sampleAsRest(table, simulator, bodies[i - body.volume.piece], source->volume_mm3, values);
    const std::vector<c3de_param_value> params = toAbi(values);
    const c3de_sim_grid grid = toAbi(source->fill.geometry);
    const c3de_sim_fill fill{sizeof(c3de_sim_fill), 0, &grid, source->fill.values.data()};
    const c3de_sim_placement placement = toAbi(body.placement);
    auto abi = toAbi<c3de_sim_body>(body.name, lease, placement, params);
    if (body.mesh.empty()) abi.fill = &fill;
    const render::Colour colour = render::shownColour(source->colour.value_or(std::array<float, 3>{}));
    if (source->colour) abi.colour = colour.data();
    abi.progress = partProgress.abi();
    scene::SceneBody placed = body;
    std::vector<std::vector<ParameterValue>> partValues = fitted.parts[i];
    for (std::size_t k = source->tissues.size(); k-- > 0;) {
      placed.parts[k].region.voxels = source->tissues[k];
      if (source->tissues[k]) continue;
      placed.parts.erase(placed.parts.begin() + static_cast<std::ptrdiff_t>(k));
      partValues.erase(partValues.begin() + static_cast<std::ptrdiff_t>(k));
    }
    placed.rigidTissue = source->rigid;
    if (source->places) prepared.tissues.push_back(std::move(*source->places));
    const BodyTables tables(scene, placed, partValues);
    tables.fill(abi);
    c3de_handle added{};
    const auto add = [&] { return table->add_body(simulator, &abi, &added); };
    if (const c3de_status code = partProgress.call(host->ownerOf(simulator), "add_body of a simulator", add); code < 0)
      return tl::unexpected(lastError(code, scene, body.line, "building body '" + body.name + "'", &placed));
    tellThin(table, simulator, added, body, *source);
    bodies.push_back(added);
  }
  return bodies;
}

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
  // Jobs of ours use simulators; simulators are code of plugins; plugins use everything else.
  impl_->jobs.finishOwnedBy(kJobOwner);
  if (impl_->simulation) impl_->simulation->table()->attach(impl_->simulation->object(), c3de_handle{0});
  impl_->release(std::move(impl_->simulation), impl_->node);
  impl_->host.reset();
}

Expected<std::unique_ptr<Session>> Session::create(const SessionOptions &options) {
  auto impl = std::make_unique<Impl>(options.threads, options.panels != nullptr);

  const auto materialsFile = findResource("materials.toml");
  auto materials = materialsFile ? scene::MaterialLibrary::load(*materialsFile)
                                 : Expected<scene::MaterialLibrary>(tl::unexpected(materialsFile.error()));
  if (materials)
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
  services.panels = options.panels;
  services.parameters = options.parameters != nullptr ? options.parameters : &impl->parameters;
  services.tools = options.tools;
  services.edits = options.edits;
  services.commands = options.commands;
  services.meshFormats = &impl->meshFormats;
  services.settings = &impl->settings;
  impl->host = std::make_unique<plugin_host::PluginHost>(services, options.loadRules);
  std::unique_ptr<Session> session(new Session(std::move(impl)));
  // Named plugins first, so that they shadow those of the folders.
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
Handle Session::simulationNode() const { return impl_->node; }

void Session::setPublishedHook(std::function<void(const scene::Simulation &)> hook) {
  impl_->publishedHook = std::move(hook);
}

Expected<SimulatorIdentity> Session::chooseSimulator(const std::string &classId) const {
  const std::vector<std::string> ids = impl_->host->classesWith(C3DE_IFACE_SIMULATOR_ID);
  if (ids.empty())
    return fail(ErrorCode::plugin, std::string("no loaded plugin offers a class that answers ") +
                                       C3DE_IFACE_SIMULATOR_ID + "; folders searched: " + listOf(impl_->folders) +
                                       "; `c3de plugins` says what was found and why it was refused");
  std::string list;
  for (const std::string &id : ids) list += (list.empty() ? "" : ", ") + id;
  const std::string wanted = !classId.empty() ? classId : impl_->simulatorClass;
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

Expected<void> Session::populate(c3de_object *simulator, const scene::SceneFile &asked, const ProgressFn &progress,
                                 Prepared *prepared, BodySources *sources) {
  const auto tableOrError = simulatorTable(simulator);
  if (!tableOrError) return tl::unexpected(tableOrError.error());
  const c3de_simulator_v1 *table = *tableOrError;
  Prepared unused;
  BodySources ofThis;
  if (prepared == nullptr) prepared = &unused;
  if (sources == nullptr) sources = &ofThis;
  scene::SceneFile copy;
  const auto same = settled(simulator, asked, impl_->materials, *sources, progress, prepared->took, copy);
  if (!same) return tl::unexpected(same.error());
  const scene::SceneFile &scene = **same;
  const auto fitted = fitScene(simulator, scene);
  if (!fitted) return tl::unexpected(fitted.error());

  const std::vector<c3de_param_value> world = toAbi(fitted->world);
  if (const c3de_status code = table->set_world(simulator, world.data(), world.size(), sizeof(c3de_param_value));
      code < 0)
    return tl::unexpected(impl_->lastError(code, scene, 0, "setting the world"));

  const std::size_t parts = scene.obstacles.size() + scene.bodies.size();
  std::size_t part = 0;
  std::map<std::string, c3de_handle> named{{scene::kWallsName, c3de_handle{0}}};  // for pairs
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    const scene::SceneObstacle &obstacle = scene.obstacles[i];
    PartProgress partProgress(progress, obstacle.name, part++, parts);
    const auto unit = impl_->meshFormats.unitOf(obstacle.mesh, obstacle.meshUnit);
    if (!unit) return fail(unit.error().code, scene.where(obstacle.line) + ": " + unit.error().message);
    auto mesh = impl_->meshFormats.load(
        obstacle.mesh, *unit, [&](double f, const std::string &what) { return partProgress.update(f, what); });
    if (!mesh) return fail(mesh.error().code, scene.where(obstacle.line) + ": " + mesh.error().message);
    const MeshLease lease(impl_->meshes, std::move(*mesh));
    const std::vector<c3de_param_value> params = toAbi(fitted->obstacles[i]);
    const c3de_sim_placement placement = toAbi(obstacle.placement);
    auto abi = toAbi<c3de_sim_obstacle>(obstacle.name, lease, placement, params);
    c3de_sim_motion motion{};
    if (obstacle.motion) {
      motion = toAbi(*obstacle.motion);
      abi.motion = &motion;
    }
    c3de_handle added{};
    const auto add = [&] { return table->add_obstacle(simulator, &abi, &added); };
    const char *owner = impl_->host->ownerOf(simulator);
    if (const c3de_status code = partProgress.call(owner, "add_obstacle of a simulator", add); code < 0)
      return tl::unexpected(impl_->lastError(code, scene, obstacle.line, "adding obstacle '" + obstacle.name + "'"));
    named[obstacle.name] = added;
  }

  auto bodies = impl_->addBodies(
      table, simulator, scene, *fitted, *sources,
      [&](double f, const std::string &what) {
        const auto before = static_cast<double>(scene.obstacles.size()), own = static_cast<double>(scene.bodies.size());
        return !progress || progress(f < 0.0 ? f : (before + f * own) / (before + own), what);
      },
      *prepared);
  if (!bodies) return tl::unexpected(bodies.error());

  for (const scene::SceneProbe &probe : scene.probes) {
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                   [&](const scene::SceneBody &candidate) { return candidate.name == probe.body; });
    const c3de_handle handle = (*bodies)[static_cast<std::size_t>(body - scene.bodies.begin())];
    c3de_handle added{};
    if (const c3de_status code =
            table->add_probe(simulator, c3de::toAbi(probe.name), handle, probe.at_m.data(), &added);
        code < 0)
      return tl::unexpected(impl_->lastError(code, scene, probe.line, "adding probe '" + probe.name + "'"));
  }
  for (std::size_t i = 0; i < bodies->size(); ++i) named[scene.bodies[i].name] = (*bodies)[i];
  return impl_->addTouch(simulator, scene, std::move(named));
}

/// Attachments, grasps; probe tools, after the bodies that they may stand in, and then the pairs that may name them.
Expected<void> Session::Impl::addTouch(c3de_object *simulator, const scene::SceneFile &scene,
                                       std::map<std::string, c3de_handle> named) const {
  named[scene::kSurroundingsName] = {0};
  const auto attachments = attachmentTable(simulator);
  if (!attachments) return tl::unexpected(attachments.error());
  for (const scene::SceneAttachment &attachment : scene.attachments) {
    const c3de_sim_region region = toAbi(attachment.region.value_or(scene::SceneRegion{}));
    c3de_sim_attachment abi{};
    abi.size = sizeof abi;
    abi.flags = attachment.within_m ? C3DE_SIM_ATTACHMENT_WITHIN : 0u;
    abi.name = c3de::toAbi(attachment.name);
    abi.first = named.at(attachment.names[0]);
    abi.second = named.at(attachment.names[1]);
    abi.region = &region;
    abi.within_m = attachment.within_m.value_or(0.0);
    abi.stiffness_Pa_m = attachment.stiffness_Pa_m;
    abi.tangential_Pa_m = attachment.tangential_Pa_m;
    abi.tears_at_Pa = attachment.tearsAt_Pa;
    c3de_handle added{};
    if (const c3de_status code = (*attachments)->add(simulator, &abi, &added); code < 0)
      return tl::unexpected(lastError(code, scene, attachment.line, "adding attachment '" + attachment.name + "'"));
  }
  const auto grasps = graspTable(simulator);
  if (!grasps) return tl::unexpected(grasps.error());
  for (const scene::SceneGrasp &grasp : scene.grasps) {
    const std::vector<c3de_sim_grasp_place> path = toAbi(grasp.path);
    c3de_sim_grasp abi = toAbi(grasp, path);
    abi.body = named.at(grasp.body);
    c3de_handle added{};
    if (const c3de_status code = (*grasps)->add(simulator, &abi, &added); code < 0)
      return tl::unexpected(lastError(code, scene, grasp.line, "adding grasp '" + grasp.name + "'"));
  }
  if (scene.probeTools.empty() && scene.contactPairs.empty()) return {};
  const auto table = contactTable(simulator);
  if (!table) return tl::unexpected(table.error());
  for (const scene::SceneProbeTool &tool : scene.probeTools) {
    const std::vector<c3de_sim_tool_place> path = toAbi(tool.path);
    const c3de_sim_probe_tool abi = toAbi(tool, path);
    c3de_handle added{};
    if (const c3de_status code = (*table)->add_probe_tool(simulator, &abi, &added); code < 0)
      return tl::unexpected(lastError(code, scene, tool.line, "adding probe tool '" + tool.name + "'"));
    named[tool.name] = added;
  }
  for (const scene::SceneContactPair &pair : scene.contactPairs) {
    c3de_sim_contact_pair abi{};
    abi.size = sizeof abi;
    abi.flags = (pair.friction ? C3DE_SIM_PAIR_HAS_FRICTION : 0u) | (pair.enabled ? 0u : C3DE_SIM_PAIR_OFF) |
                (pair.fits ? C3DE_SIM_PAIR_FITS : 0u);
    abi.first = named.at(pair.names[0]);
    abi.second = named.at(pair.names[1]);
    abi.friction = pair.friction.value_or(0.0);
    if (const c3de_status code = (*table)->set_pair(simulator, &abi); code < 0)
      return tl::unexpected(lastError(code, scene, pair.line,
                                      "setting the contact of '" + pair.names[0] + "' and '" + pair.names[1] + "'"));
  }
  return {};
}

Expected<void> Session::addBodies(c3de_object *simulator, const scene::SceneFile &asked, const ProgressFn &progress,
                                  Prepared *prepared) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  Prepared unused;
  if (prepared == nullptr) prepared = &unused;
  BodySources sources;
  scene::SceneFile copy;
  const auto same = settled(simulator, asked, impl_->materials, sources, progress, prepared->took, copy);
  if (!same) return tl::unexpected(same.error());
  const scene::SceneFile &scene = **same;
  const auto fitted = fitScene(simulator, scene);
  if (!fitted) return tl::unexpected(fitted.error());
  const auto added = impl_->addBodies(*table, simulator, scene, *fitted, sources, progress, *prepared);
  if (!added) return tl::unexpected(added.error());
  return {};
}

Handle Session::Impl::addNode(const std::string &title) {
  const Handle added = sceneGraph.add({}, title);
  Mat4 worldFromSimulation = kIdentity4;
  for (std::size_t axis = 0; axis < 3; ++axis) worldFromSimulation[5 * axis] = scene::kMillimetresPerMetre;
  sceneGraph.find(added)->parentFromNode = worldFromSimulation;
  sceneGraph.touch();
  return added;
}

void Session::Impl::connect(Handle at, const std::string &title, const std::shared_ptr<scene::Simulation> &to) {
  to->setBeforeStep(
      [fields = &forces, at, object = to->object(), table = to->table()] { return fields->apply(at, object, table); });
  to->setAfterStep([all = &simulations, at](const c3de_sim_status &status) { all->stepped(at, status); });
  simulations.add(at, title, to);
}

Expected<void> Session::adopt(c3de_object *simulator, const std::string &title) {
  return adopt(simulator, title, false);
}

Expected<void> Session::adoptForRun(c3de_object *simulator, const std::string &title) {
  return adopt(simulator, title, true);
}

Expected<void> Session::adopt(c3de_object *simulator, const std::string &title, bool isDrivenByCaller) {
  plugin_host::PluginHost *host = impl_->host.get();
  const auto takeError = [host] { return host->takeError(); };
  const char *owner = host->ownerOf(simulator);
  auto created = isDrivenByCaller ? scene::Simulation::createForCaller(simulator, takeError, owner)
                                  : scene::Simulation::create(simulator, takeError, owner);
  if (!created) return tl::unexpected(created.error());
  std::shared_ptr<scene::Simulation> next = std::move(*created);
  if (!isDrivenByCaller)
    next->setPublishedListener([queue = &impl_->mainQueue, hook = impl_->publishedHook, simulation = next.get()] {
      if (hook) hook(*simulation);
      queue->requestRedraw();
    });

  const Handle nextNode = impl_->addNode(title);
  impl_->connect(nextNode, title, next);

  // The one before lets go of its panels and proxies first, so that there is never a second set of them.
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
  impl_->release(std::exchange(impl_->simulation, std::move(next)), std::exchange(impl_->node, nextNode));
  return {};
}

}  // namespace c3de::session
