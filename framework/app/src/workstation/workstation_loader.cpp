// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation_loader.h"

#include <algorithm>
#include <memory>

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/session/default_floor.h"
#include "c3de/session/session_file.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {
namespace {

std::string namesOf(const std::vector<std::filesystem::path> &files) {
  std::string text;
  for (const auto &file : files) text += (text.empty() ? "" : ", ") + pathText(file.filename());
  return text;
}

/// Bodies are addressed by name, so two meshes of the same name need different ones.
std::string uniqueName(const scene::SceneFile &scene, const std::string &wanted) {
  const auto isUsed = [&](const std::string &name) {
    return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                       [&](const scene::SceneBody &body) { return body.name == name; });
  };
  std::string name = wanted;
  for (int i = 2; isUsed(name); ++i) name = wanted + " " + std::to_string(i);
  return name;
}

std::string unitText(const geometry::MeshFormats &formats, const std::vector<std::filesystem::path> &files,
                     const std::string &stated) {
  std::string text;
  for (const std::filesystem::path &file : files) {
    if (scene::isScenePath(file)) continue;
    const auto said = formats.unitInFile(file);
    const std::string unit = !stated.empty() ? stated + ", as requested"
                             : said          ? std::string(geometry::unitName(*said)) + ", as the file states"
                                             : "mm, because the file states no unit";
    if (text.find(unit) == std::string::npos) text += (text.empty() ? "" : "; ") + unit;
  }
  return text;
}

/// The scene with the walls that were added to its simulation.
SharedScene withWalls(scene::SceneFile scene, const Bounds_m &walls) {
  for (const ParameterValue &value : wallParameters(walls)) {
    scene.world.emplace_back();
    scene.world.back().value = value;
  }
  return std::make_shared<const scene::SceneFile>(std::move(scene));
}

/// Of the present simulation: what the view is fitted to.
void setBounds(Session &session, const Bounds_m &bounds) {
  scene::Node *node = session.sceneGraph().find(session.simulationNode());
  if (node == nullptr) return;
  node->hasBounds = true;
  node->boundsMin = bounds.min;
  node->boundsMax = bounds.max;
  session.sceneGraph().touch();
}

}  // namespace

Expected<scene::SceneFile> WorkstationLoader::read(const std::vector<std::filesystem::path> &files,
                                                   const std::string &meshUnit) const {
  const auto stated = scene::parseLengthUnit(meshUnit.empty() ? "mm" : meshUnit);
  if (!stated) return tl::unexpected(stated.error());
  scene::SceneFile result;
  bool hasResult = false;
  const auto scenes = std::count_if(files.begin(), files.end(), scene::isScenePath);
  if (scenes > 1)
    return fail(ErrorCode::usage,
                "several scenes at once: " + namesOf(files) + "; accepted: one scene, and meshes to add to it");
  if (scenes == 1) {
    auto loaded =
        scene::loadScene(*std::find_if(files.begin(), files.end(), scene::isScenePath), &session_.materials());
    if (!loaded) return loaded;
    result = std::move(*loaded);
    hasResult = true;
  }
  for (const std::filesystem::path &file : files) {
    if (scene::isScenePath(file)) continue;
    if (const auto good = checkInputFile(file); !good)
      return fail(ErrorCode::input, good.error().message + "; accepted: meshes, images and scenes (.toml)");
    scene::SceneFile one = scene::sceneForMesh(
        file, meshUnit.empty() ? session_.meshFormats().unitInFile(file).value_or(geometry::LengthUnit::millimetre)
                               : *stated);
    if (!hasResult) {
      result = std::move(one);
      hasResult = true;
      continue;
    }
    for (scene::SceneBody &body : one.bodies) {
      body.name = uniqueName(result, body.name);
      result.bodies.push_back(std::move(body));
    }
  }
  return result;
}

Expected<scene::SceneFile> WorkstationLoader::sceneOf(const Source &source) const {
  if (source.session) return *std::get<SharedScene>(source.session->source.front());
  if (!source.text.empty()) return scene::parseScene(source.text, {}, &session_.materials());
  return read(source.files, source.meshUnit);
}

Expected<void> WorkstationLoader::restore(const OpenedSession &opened, c3de_object *simulator,
                                          const SimulatorIdentity &identity, std::string &notRestored) const {
  if (!opened.usesChangedFiles) return restoreSession(session_, simulator, identity, opened.saved, opened.file);
  auto reason = restoreIfPossible(session_, simulator, identity, opened.saved, opened.file);
  if (!reason) return tl::unexpected(reason.error());
  notRestored = std::move(*reason);
  return {};
}

Expected<void> WorkstationLoader::build(Build &build, const OpenedSession *opened, const ProgressFn &progress) const {
  c3de_object *simulator = build.simulator.get();
  if (auto populated = session_.populate(simulator, *build.scene, progress, &build.prepared); !populated)
    return populated;
  if (opened) {
    if (auto built = buildRemaining(session_, simulator, opened->source, progress, &build.prepared); !built)
      return built;
    if (auto restored = restore(*opened, simulator, build.identity, build.notRestored); !restored) return restored;
    if (opened->continuesFrom) {
      auto continued = continueFrom(session_, simulator, opened->continuesFrom->get());
      if (!continued) return tl::unexpected(continued.error());
      *opened->continued = std::move(*continued);
      *opened->continuesFrom = ObjectRef();
    }
  }
  build.bodies = boundsOfBodies(simulator);
  if (build.needsFloor && build.bodies) {
    const auto room = addSurroundingWalls(simulator, *build.bodies);
    if (!room) return tl::unexpected(room.error());
    build.room = *room;
  }
  // The first frame that shows the simulation shows its state, not the defaults of the panel.
  publishSnapshot(simulator);
  return {};
}

void WorkstationLoader::load(Source source, bool isReload) {
  const bool isText = !source.text.empty();
  if (source.files.empty() && !isText && !source.session) return;
  const std::string name = isText ? "the body of the scan" : namesOf(source.files);
  const std::string title = (isText ? "Could not make " : "Could not open ") + name;
  const std::string action = source.session ? source.session->action : std::string();
  const auto failed = [this, title, done = source.done](const Error &error) {
    if (done)
      done(tl::unexpected(error));
    else
      events_.failed(title, error);
  };
  if (!session_.simulation() && action.empty()) source_ = source;
  auto scene = sceneOf(source);
  if (!scene) return failed(scene.error());
  const auto identity =
      session_.chooseSimulator(action.empty() ? scene->simulatorClass : source.session->saved.simulatorClass);
  if (!identity) return failed(identity.error());
  auto created = session_.createSimulator(identity->classId);
  if (!created) return failed(created.error());

  if (!job_.isNull()) session_.jobs().cancel(job_);
  const std::uint64_t serial = ++serial_;
  // The job and its completion share it; the last of them releases the simulator.
  const auto built = std::make_shared<Build>();
  built->simulator = ObjectRef(*created);
  built->identity = *identity;
  built->scene = std::make_shared<const scene::SceneFile>(std::move(*scene));
  built->needsFloor =
      !isText && !source.session && std::none_of(source.files.begin(), source.files.end(), scene::isScenePath);
  std::string sceneTitle = source.session ? source.session->title : std::string();
  if (sceneTitle.empty()) sceneTitle = built->scene->title.empty() ? name : built->scene->title;
  job_ = session_.jobs().submit(
      kJobOwner, !action.empty() ? action : (isText ? "Making " : "Opening ") + name,
      [this, built, opened = source.session](const ProgressFn &progress) {
        return build(*built, opened.get(), progress);
      },
      [this, built, sceneTitle, source, failed, isReload, isText, serial](const Expected<void> &result) {
        // A later request has replaced this one.
        if (serial != serial_) {
          if (source.done) source.done(fail(ErrorCode::cancelled, "something else was opened"));
          return;
        }
        job_ = {};
        if (!result) return failed(result.error());
        if (source.session && source.session->isOutdated && source.session->isOutdated())
          return failed({ErrorCode::state, "the simulation was changed meanwhile"});
        SimulationSource all = source.session ? source.session->source : SimulationSource{built->scene};
        if (built->room) all.front() = withWalls(*built->scene, *built->room);
        if (auto adopted = session_.adopt(built->simulator.get(), sceneTitle, std::move(all)); !adopted)
          return failed(adopted.error());
        if (!source.session || source.session->action.empty()) source_ = source;
        double size_mm = 0.0;
        if (built->bodies) size_mm = scene::kMillimetresPerMetre * norm(built->bodies->max - built->bodies->min);
        if (built->room) setBounds(session_, framedWith(*built->bodies, *built->room));
        events_.loaded({isReload, source.session, built->notRestored, size_mm,
                        unitText(session_.meshFormats(), source.files, source.meshUnit), built->scene->image, isText,
                        built->prepared.coverage, built->prepared.tissues});
        if (source.done) source.done({});
      });
}

}  // namespace c3de::app
