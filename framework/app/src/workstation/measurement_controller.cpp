// SPDX-License-Identifier: Apache-2.0
#include "workstation/measurement_controller.h"

#include <map>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/session/landmark_file.h"
#include "c3de/session/recording_file.h"

namespace c3de::app {
namespace {

using scene::kMillimetresPerMetre;

ui::MeasurementSet setOfScene(const scene::SceneFile &scene) {
  ui::MeasurementSet set;
  for (const scene::SceneLandmark &one : scene.landmarks) {
    ui::MeasuredPoint point{one.name, one.body, kMillimetresPerMetre * one.at_m, {}, false, true};
    if (one.target_m) point.target_mm = kMillimetresPerMetre * *one.target_m;
    set.points.push_back(std::move(point));
  }
  // The window has one name space, a scene one for each kind.
  const auto add = [&set](const std::string &name, std::vector<std::string> points) {
    set.measures.push_back({set.has(name) ? set.freeName(name) : name, std::move(points), false, true});
  };
  for (const scene::SceneDistance &one : scene.distances) add(one.name, {one.between.begin(), one.between.end()});
  for (const scene::SceneAngle &one : scene.angles) add(one.name, {one.at.begin(), one.at.end()});
  return set;
}

std::string lowered(std::string text) {
  text[0] = static_cast<char>(text[0] - 'A' + 'a');
  return text;
}

}  // namespace

SavedMeasurements savedOf(const ui::MeasurementSet &set) {
  SavedMeasurements saved;
  for (const ui::MeasuredPoint &one : set.points)
    saved.points.push_back({one.name, one.body, one.reference_mm, one.target_mm, one.isHidden, one.isOfScene});
  for (const ui::Measure &one : set.measures)
    saved.measures.push_back({one.name, one.points, one.isHidden, one.isOfScene});
  return saved;
}

ui::MeasurementSet setOf(const SavedMeasurements &saved) {
  ui::MeasurementSet set;
  for (const auto &one : saved.points)
    set.points.push_back({one.name, one.body, one.at_mm, one.target_mm, one.isHidden, one.isOfScene});
  for (const auto &one : saved.measures) set.measures.push_back({one.name, one.points, one.isHidden, one.isOfScene});
  return set;
}

MeasurementController::MeasurementController(Parts parts)
    : parts_(std::move(parts)), list_(&parts_.edits),
      tools_(ui::MeasurementTools::Parts{
          list_, &parts_.images.views(), &parts_.renderer,
          [this](const Vec3 &at) { return parts_.window.camera().millimetresPerPixel(at, parts_.window.viewHeight()); },
          [this](ui::MeasureKind kind, const std::vector<ui::MeasurementPick> &picks) { place(kind, picks); },
          [this](const std::string &name, const ui::MeasurementPick &pick) {
            resolve({{{}, pick.at_mm, pick.isAtRest}}, [this, name](const std::vector<Vec3> &at) {
              ui::MeasurementSet set = list_.set();
              for (ui::MeasuredPoint &one : set.points)
                if (one.name == name) {
                  one.reference_mm = at.front();
                  one.body.clear();
                }
              list_.edit("move " + name, std::move(set));
            });
          },
          [this](const std::string &name) {
            ui::MeasurementSet set = list_.set();
            set.remove(name);
            list_.edit("delete " + name, std::move(set));
          },
          [this](const std::string &name, const Vec3 &at_mm, bool isInSlice) { placeTarget(name, at_mm, isInSlice); }}),
      tracker_([this] { return parts_.session.plugins().takeError(); }) {
  tools_.addTo(parts_.tools);
}

void MeasurementController::connect(ui::WindowActions &actions) {
  using Path = std::filesystem::path;
  actions.loadLandmarks = [this](const Path &file) { load(file); };
  actions.loadTargetLandmarks = [this](const Path &file) { loadTargets(file); };
  actions.saveLandmarks = [this](const Path &file) { save(file); };
  actions.exportCurves = [this](const Path &file) { exportCurves(file); };
}

void MeasurementController::place(ui::MeasureKind kind, const std::vector<ui::MeasurementPick> &picks) {
  resolve(picks, [this, kind, picks](const std::vector<Vec3> &at) {
    ui::MeasurementSet set = list_.set();
    std::vector<std::string> names;
    for (std::size_t i = 0; i < picks.size(); ++i) {
      std::string name = picks[i].name;
      if (!set.point(name)) {
        name = set.freeName(ui::kindName(ui::MeasureKind::landmark));
        set.points.push_back({name, {}, at[i], {}, false, false});
      }
      names.push_back(name);
    }
    std::string added = names.front();
    if (kind != ui::MeasureKind::landmark) {
      added = set.freeName(ui::kindName(kind));
      set.measures.push_back({added, names, false, false});
    }
    list_.edit("add " + lowered(added), std::move(set));
    list_.selected = added;
    // Until the simulator has been asked.
    for (std::size_t i = 0; i < picks.size(); ++i)
      if (picks[i].name.empty() && !picks[i].isAtRest) list_.placeNow(names[i], picks[i].at_mm);
  });
}

void MeasurementController::placeTarget(const std::string &name, const Vec3 &at_mm, bool isInSlice) {
  const ui::ImageViews &views = parts_.images.views();
  const bool isMoved = isInSlice && views.isCompared() && views.comparison()->revision() != 0;
  ui::MeasurementSet set = list_.set();
  if (!set.point(name)) return;
  set.setTarget(name,
                isMoved ? transformPoint(geometry::rigidInverse(views.comparison()->worldFromSecond()), at_mm) : at_mm);
  list_.edit("set target of " + name, std::move(set));
  list_.selected = name;
  if (isMoved)
    parts_.panels.notify(C3DE_LOG_INFO, "Target of " + name,
                         "It is at its position in the file of the second scan, without the motion of Compare.");
}

void MeasurementController::resolve(const std::vector<ui::MeasurementPick> &picks, Resolved done) {
  std::vector<Vec3> at_mm, now_mm;
  bool isNeeded = false;
  for (const ui::MeasurementPick &one : picks) {
    at_mm.push_back(one.at_mm);
    isNeeded = isNeeded || (one.name.empty() && !one.isAtRest);
  }
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation || !isNeeded) return done(at_mm);
  simulation->post([this, simulation, picks, at_mm, changes = parts_.session.changes(), done = std::move(done)] {
    Expected<std::vector<Vec3>> found;
    try {
      const ChangeLog::Unrecorded reads(*changes);
      found = referencesOf(simulation->object(), at_mm, [this] { return parts_.session.plugins().takeError(); });
    } catch (const std::exception &error) {
      found = fail(ErrorCode::internal, error.what());
    }
    for (std::size_t i = 0; found && i < picks.size(); ++i)
      if (picks[i].isAtRest) (*found)[i] = picks[i].at_mm;
    parts_.session.mainQueue().post([this, found, done] {
      if (found)
        done(*found);
      else
        parts_.failed("The point was not placed", found.error());
    });
  });
}

void MeasurementController::load(const std::filesystem::path &file) {
  const auto read = readLandmarks(file);
  if (!read) return parts_.failed("Could not load " + pathText(file.filename()), read.error());
  ui::MeasurementSet set = list_.set();
  std::size_t added = 0, renamed = 0;
  for (const FileLandmark &one : *read) {
    const ui::MeasuredPoint *same = set.point(one.name);
    if (same && same->reference_mm == one.lps_mm) continue;
    const bool isTaken = set.has(one.name);
    set.points.push_back({isTaken ? set.freeName(one.name) : one.name, {}, one.lps_mm, {}, false, false});
    ++added;
    if (isTaken) ++renamed;
  }
  list_.edit("load landmarks", std::move(set));
  std::string text = std::to_string(added) + " of " + std::to_string(read->size()) + " are new: " + pathText(file);
  if (renamed > 0) text += "\nNames that were in use have a number added.";
  parts_.panels.notify(C3DE_LOG_INFO, "Landmarks loaded", text);
}

void MeasurementController::loadTargets(const std::filesystem::path &file) {
  const std::string title = "Could not load " + pathText(file.filename());
  const auto read = readLandmarks(file);
  if (!read) return parts_.failed(title, read.error());
  ui::MeasurementSet set = list_.set();
  std::vector<std::string> names;
  for (const ui::MeasuredPoint &one : set.points) names.push_back(one.name);
  for (const FileLandmark &one : *read) {
    if (set.point(one.name)) {
      set.setTarget(one.name, one.lps_mm);
      continue;
    }
    const std::string nearest = nearestName(one.name, names);
    return parts_.failed(
        title, {ErrorCode::input, one.where + ": there is no landmark '" + displayText(one.name) + "'; " +
                                      (nearest.empty() ? "" : "did you mean '" + displayText(nearest) + "'? ") +
                                      "accepted: names of landmarks in the table"});
  }
  list_.edit("load target landmarks", std::move(set));
}

void MeasurementController::save(const std::filesystem::path &file) {
  std::vector<WrittenLandmark> written;
  for (const ui::MeasuredPoint &one : list_.set().points)
    written.push_back({one.name, one.reference_mm, list_.positionOf(one)});
  auto saved = checkLandmarkPath(file, "the name of the file");
  if (saved) saved = writeLandmarks(file, written);
  if (!saved) return parts_.failed("The landmarks could not be saved", saved.error());
  parts_.panels.notify(C3DE_LOG_INFO, "Landmarks saved", pathText(file));
}

void MeasurementController::exportCurves(const std::filesystem::path &file) {
  const auto written = writeWholeFile(file, list_.curvesCsv());
  if (!written) return parts_.failed("The curves could not be exported", written.error());
  parts_.panels.notify(C3DE_LOG_INFO, "Exported", pathText(file));
}

std::shared_ptr<const scene::SceneFile> MeasurementController::presentScene() const {
  const std::shared_ptr<ChangeLog> changes = parts_.session.changes();
  const SimulationSource source = changes ? changes->source() : SimulationSource();
  const auto *first = source.empty() ? nullptr : std::get_if<SharedScene>(&source.front());
  return first ? *first : nullptr;
}

void MeasurementController::onLoaded(const WorkstationLoader::Loaded &loaded) {
  isRefollowed_ = true;
  const bool isOther = std::exchange(hadSimulation_, true) && !loaded.isReload;
  if (loaded.session && !loaded.session->action.empty()) return;
  list_.forgetPositions();
  if (loaded.session && loaded.session->saved.view.measurements) return;
  const auto scene = presentScene();
  const ui::MeasurementSet ofScene = scene ? setOfScene(*scene) : ui::MeasurementSet();
  const bool isRecording = loaded.session && isRecordingPath(loaded.session->file);
  ui::MeasurementSet set = isOther && !isRecording && !loaded.isImageOpen ? ui::MeasurementSet() : list_.set();
  set.mergeScene(ofScene);
  list_.assign(std::move(set));
}

void MeasurementController::onBodiesChanged() {
  isRefollowed_ = true;
  hadSimulation_ = parts_.session.simulation() != nullptr;
}

void MeasurementController::onRemoved() {
  hadSimulation_ = false;
  isRefollowed_ = true;
  list_.forgetPositions();
}

void MeasurementController::follow() {
  isRefollowed_ = false;
  followedRevision_ = list_.revision();
  std::vector<Landmark> landmarks;
  if (parts_.session.simulation() != nullptr)
    for (const ui::MeasuredPoint &one : list_.set().points)
      landmarks.push_back({one.name, one.body, (1.0 / kMillimetresPerMetre) * one.reference_mm, one.reference_mm,
                           one.target_mm, "landmark '" + displayText(one.name) + "'"});
  tracker_.follow(std::move(landmarks), presentScene(), parts_.session.changes());
}

void MeasurementController::update() {
  scene::Simulation *simulation = parts_.session.simulation();
  if (isRefollowed_ || list_.revision() != followedRevision_) {
    follow();
    if (simulation && tracker_.isBehind()) simulation->post([] {});  // publishes once more
  } else if (simulation && tracker_.isBehind() && simulation->state().mode != C3DE_SIM_PLAYING) {
    simulation->post([] {});
  }
  const auto newest = tracker_.newest();
  if (!newest || newest == shown_) return;
  shown_ = newest;
  std::map<std::string, Vec3> at_mm;
  for (std::size_t i = 0; i < newest->landmarks.size(); ++i) at_mm[newest->landmarks[i].name] = newest->at_mm[i];
  list_.addPositions(at_mm, newest->time_s);
  if (newest->problem == reportedProblem_) return;
  reportedProblem_ = newest->problem;
  if (!reportedProblem_.empty())
    parts_.panels.notify(C3DE_LOG_WARN, "Landmarks are shown at rest", reportedProblem_, {},
                         registry::About::simulation);
}

}  // namespace c3de::app
