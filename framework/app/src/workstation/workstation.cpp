// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/plain_words.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/interrupt.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/view_controller.h"
#include "c3de/ui/workstation_window.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "workstation/body_creation_controller.h"
#include "workstation/body_update_controller.h"
#include "workstation/comparison_controller.h"
#include "workstation/export_controller.h"
#include "workstation/figure_controller.h"
#include "workstation/match_controller.h"
#include "workstation/measurement_controller.h"
#include "workstation/plot_controller.h"
#include "workstation/plugin_problems.h"
#include "workstation/preferences_controller.h"
#include "workstation/recent_files_controller.h"
#include "workstation/recording_controller.h"
#include "workstation/replay_controller.h"
#include "workstation/report_controller.h"
#include "workstation/session_controller.h"
#include "workstation/simulation_controller.h"
#include "workstation/simulation_history.h"
#include "workstation/tissue_surface_controller.h"
#include "workstation/tissue_table_controller.h"
#include "workstation/warp_controller.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {
namespace {

constexpr double kSmallOrgan_mm = 20.0, kLargeOrgan_mm = 5000.0;

/// Extensions separated by semicolons, without their dots.
std::string listed(const std::vector<std::string> &extensions) {
  std::string text;
  for (const std::string &extension : extensions) text += (text.empty() ? "" : ";") + extension.substr(1);
  return text;
}

/// With a wrong unit an organ has the size of a house or of a grain, and all subsequent results are wrong.
void checkSize(const WorkstationLoader::Loaded &loaded, registry::PanelRegistry &panels) {
  if (loaded.unit.empty() || !(loaded.size_mm > 0.0)) return;
  if (loaded.size_mm < kSmallOrgan_mm || loaded.size_mm > kLargeOrgan_mm)
    panels.notify(C3DE_LOG_WARN, "Is the unit right?",
                  "The numbers in the file were read as " + loaded.unit + ". That makes what is shown " +
                      formatNumber(std::round(loaded.size_mm * 10.0) / 10.0) +
                      " mm across. File > Open mesh… asks for another unit; on the command line it is --unit.",
                  {}, registry::About::simulation);
}

/// One run of the window: constructs its parts and connects them. Members are destroyed from the last to the first: the
/// session releases its plugins while registries, renderer and graphics context still exist.
class Workstation {
 public:
  [[nodiscard]] Expected<void> start(const WorkstationOptions &options);
  void run();

 private:
  [[nodiscard]] Expected<void> openWindow(const WorkstationOptions &options);
  [[nodiscard]] Expected<void> createSession(SessionOptions &options);
  void createControllers();
  void connectWindow();
  void apply(const ui::Preferences &preferences);
  [[nodiscard]] ui::WindowActions actions();
  [[nodiscard]] std::string unsaved();
  [[nodiscard]] std::string whyNoMatch() const;
  void open(const ui::OpenRequest &request);
  [[nodiscard]] RecentFilesController::Shown shownFiles() const;
  void onImageShown();
  void closeImage();
  void closeSimulation();
  void removeSimulation();
  void onBodiesJoined(bool isNew, bool hasReplaced);
  void onLoaded(const WorkstationLoader::Loaded &loaded);
  void beginTissues(std::vector<TissueVoxels> bodies);
  void showLatestResults();
  void onFailed(const std::string &title, const Error &error);

  KeptLog keptLog_;
  std::optional<CrashJournal> journal_;
  registry::PanelRegistry panels_;
  registry::ParameterRegistry parameters_;
  registry::ToolRegistry tools_;
  registry::EditList edits_;
  registry::CommandRegistry commands_;
  std::unique_ptr<ui::WorkstationWindow> window_;
  std::unique_ptr<render::Renderer> renderer_;
  std::optional<PluginProblems> plugins_;
  MatchValues matchValues_;
  // Used by the jobs and the simulation of the session until they end:
  std::optional<WorkstationLoader> loader_;
  std::optional<WorkstationImages> images_;
  std::optional<TissueTableController> tissueTable_;
  std::optional<WarpController> warp_;
  std::optional<BodyCreationController> bodyCreation_;
  std::optional<SimulationController> simulation_;
  std::optional<ExportController> exports_;
  std::optional<RecordingController> recording_;
  std::optional<ReplayController> replay_;
  std::optional<ReportController> report_;
  std::optional<MeasurementController> measurements_;
  std::optional<ComparisonController> comparison_;
  std::optional<FigureController> figures_;
  std::optional<PlotController> plots_;
  std::optional<SessionController> sessions_;
  std::optional<SimulationHistory> history_;
  std::optional<BodyUpdateController> bodyUpdates_;
  std::optional<PreferencesController> preferences_;
  std::unique_ptr<Session> session_;
  std::optional<TissueSurfaceController> tissueSurfaces_;  ///< uses the session's tree
  std::optional<MatchController> match_;                   ///< likewise
  std::optional<RecentFilesController> recent_;            ///< its thread uses the session's queue
  std::vector<std::filesystem::path> loadedFiles_;  ///< of the present simulation, unless it is that of a session
  bool playsWhenLoaded_ = false;
};

Expected<void> Workstation::start(const WorkstationOptions &options) {
  if (auto opened = openWindow(options); !opened) return opened;
  SessionOptions sessionOptions = options.session;
  if (auto created = createSession(sessionOptions); !created) return created;
  playsWhenLoaded_ = options.play;
  createControllers();
  connectWindow();
  preferences_->read();
  plugins_->report(session_->plugins(), panels_);
  if (sessionOptions.loadRules.isSafeMode)
    panels_.notify(C3DE_LOG_INFO, "Safe mode", "Only the plugins that came with the program were loaded.");
  if (!options.notice.empty()) {
    log(LogLevel::warn, options.notice);
    panels_.notify(C3DE_LOG_INFO, "Another scene than usual", options.notice);
  }
  if (options.isUntitled && !options.files.empty()) sessions_->keepUnnamed(options.files.front());
  sessions_->offerRecovery();
  open({options.files, options.meshUnit, false});
  return {};
}

Expected<void> Workstation::openWindow(const WorkstationOptions &options) {
  ui::WindowOptions windowOptions;
  windowOptions.width = options.width;
  windowOptions.height = options.height;
  windowOptions.automationState = options.automationState;
  auto window = ui::WorkstationWindow::create(windowOptions);
  if (!window) return tl::unexpected(window.error());
  window_ = std::move(*window);
  auto renderer = render::createGlRenderer();
  if (!renderer) return tl::unexpected(renderer.error());
  renderer_ = std::move(*renderer);
  return {};
}

/// @param options  receives registries, renderer and what the user answers about plugins
Expected<void> Workstation::createSession(SessionOptions &options) {
  options.renderer = renderer_.get();
  options.panels = &panels_;
  panels_.setWording([this](const std::string &text) { return registry::plainWords(text, parameters_); });
  options.parameters = &parameters_;
  options.tools = &tools_;
  options.edits = &edits_;
  commands_.setProgramKeys(&ui::programCommandOf);
  options.commands = &commands_;
  if (auto journal = beginJournal(options)) journal_.emplace(std::move(*journal));
  options.loadRules.hasWindow = true;
  plugins_.emplace(*window_, *renderer_, options.loadRules);
  auto session = Session::create(options);
  if (!session) return tl::unexpected(session.error());
  session_ = std::move(*session);
  session_->mainQueue().setWaker([window = window_.get()] { window->wake(); });
  return {};
}

void Workstation::createControllers() {
  Session &session = *session_;
  const ReportError failed = [this](const std::string &title, const Error &error) { onFailed(title, error); };
  simulation_.emplace(session, panels_, [this] { window_->openReport(); });
  loader_.emplace(session, WorkstationLoader::Events{
                               [this](const WorkstationLoader::Loaded &loaded) { onLoaded(loaded); }, failed});
  WorkstationImages::Events events;
  events.shown = [this] { onImageShown(); };
  events.closed = [this] {
    comparison_->close();
    warp_->stop();
    figures_->onImageChanged();
  };
  events.failed = failed;
  events.createBodies = [this](std::vector<segmentation::BodyRequest> requests) {
    if (replay_->isReplaying()) return onFailed("The bodies were not created", {ErrorCode::state, ui::kReplayLocks});
    recording_->end("Bodies are added.");
    history_->captureBefore(
        [this, requests = std::move(requests)](std::uint64_t) { bodyCreation_->createBodies(requests); });
  };
  events.updateBody = [this](const std::string &body, std::shared_ptr<const imaging::Mask> mask,
                             const SimulationHistory::MaskRange &range) {
    bodyUpdates_->update(body, std::move(mask), range);
  };
  events.createScanBody = [this](const std::string &scene) {
    if (replay_->isReplaying()) return onFailed("The body was not created", {ErrorCode::state, ui::kReplayLocks});
    history_->captureBefore([this, scene](std::uint64_t) { bodyCreation_->createScanBody(scene); });
  };
  events.closeSimulation = [this] { closeSimulation(); };
  events.compareWith = [this](const std::filesystem::path &file, const std::string &series) {
    comparison_->open(file, series);
  };
  events.selectionRestored = [this] { sessions_->onSelectionRestored(); };
  events.askForLabelFile = [this] { window_->request(ui::Command::saveLabels); };
  images_.emplace(session, *renderer_, panels_, tools_, std::move(events));
  tissueTable_.emplace(images_->views(), [this] { window_->wake(); });
  warp_.emplace(session, *images_, tissueTable_->tracker(), failed);
  bodyCreation_.emplace(
      BodyCreationController::Parts{session, panels_, tools_, *loader_, *images_},
      BodyCreationController::Events{[this](bool isNew, bool hasReplaced) { onBodiesJoined(isNew, hasReplaced); },
                                     [this](const std::string &label, bool isPicked) {
                                       using MaskUndo = SimulationHistory::MaskUndo;
                                       history_->add(label, isPicked ? MaskUndo::ofCreation : MaskUndo::none);
                                     },
                                     failed});
  exports_.emplace(ExportController::Parts{session, panels_, *images_, *warp_, *tissueTable_, failed});
  recording_.emplace(RecordingController::Parts{session, panels_, edits_, failed,
                                                [this](const auto &file) { replay_->openPast(file); }});
  replay_.emplace(ReplayController::Parts{
      session, panels_, tools_, *loader_, failed,
      [this] {
        sessions_->onMade(false);
        report_->begin(true);
      },
      *window_, *renderer_, [this] { return !warp_->isBehind() && !tissueTable_->tracker().isBehind(); }});
  report_.emplace(ReportController::Parts{session, panels_, parameters_, keptLog_, renderer_->description(), failed});
  measurements_.emplace(
      MeasurementController::Parts{session, panels_, edits_, tools_, *images_, *window_, *renderer_, failed});
  comparison_.emplace(ComparisonController::Parts{session, *renderer_, panels_, edits_, tools_, *images_,
                                                  measurements_->list(), failed,
                                                  [this] { sessions_->onComparisonRestored(); }});
  figures_.emplace(FigureController::Parts{session, panels_, *window_, *renderer_, *images_, *measurements_, failed});
  plots_.emplace(PlotController::Parts{session, panels_, *measurements_, *figures_, failed});
  sessions_.emplace(SessionController::Parts{session, panels_, *loader_, *images_, *window_, measurements_->list(),
                                             *comparison_, matchValues_, failed});
  history_.emplace(SimulationHistory::Parts{session, panels_, edits_, *loader_, *images_, *sessions_,
                                            [this] { removeSimulation(); }, failed});
  bodyUpdates_.emplace(
      BodyUpdateController::Parts{session, panels_, tools_, *loader_, *images_, *sessions_, *history_, failed},
      [this] { return replay_->isReplaying() ? std::string(ui::kReplayLocks) : std::string(); });
  tissueSurfaces_.emplace(session, *renderer_);
  match_.emplace(MatchController::Parts{session, *renderer_, panels_, *images_, measurements_->list(), *history_,
                                        matchValues_, failed, [this] { return whyNoMatch(); }});
  recent_.emplace(RecentFilesController::Parts{session, panels_, *window_, [this] { return shownFiles(); }});
  preferences_.emplace(panels_, [this](const ui::Preferences &preferences) { apply(preferences); });
  session.setPublishedHook([this](const scene::Simulation &simulation) {
    tissueTable_->tracker().onPublished(simulation, warp_->onPublished(simulation), warp_->wanted());
    measurements_->onPublished(simulation);
    figures_->onPublished(simulation);
    plots_->onPublished(simulation);
  });
}

void Workstation::apply(const ui::Preferences &preferences) {
  window_->setPreferences(preferences);
  images_->views().setUnits(preferences.units);
  images_->setWindowLevelRules(preferences.windowLevels);
  measurements_->list().setUnits(preferences.units);
  plots_->plots().setUnits(preferences.units);
  figures_->setUnits(preferences.units);
  sessions_->setAutosaveInterval(preferences.autosave_s);
}

void Workstation::connectWindow() {
  window_->connect(
      {&panels_, &tools_, &parameters_, &session_->sceneGraph(), &session_->jobs(), &images_->views(),
       &images_->workflow(), &images_->brush(), &images_->scanBody(), &tissueTable_->table(), &edits_, &commands_,
       &recent_->page(), [this] { return listed(session_->meshFormats().extensions()); }, &sessions_->missingFiles(),
       &measurements_->list(), &measurements_->tools(), &plots_->plots(), [this] { return match_->panel(); }},
      actions());
  tools_.setMarkedPoint([this] {
    const ui::ImageViews &views = images_->views();
    return views.image() ? views.crossHair() : window_->camera().focus;
  });
  window_->setAbout(
      {"C3DE " C3DE_VERSION ", plugin ABI " + std::to_string(C3DE_ABI_MAJOR) + "." + std::to_string(C3DE_ABI_MINOR),
       renderer_->description()});
}

ui::WindowActions Workstation::actions() {
  ui::WindowActions actions;
  simulation_->connect(actions);
  exports_->connect(actions);
  measurements_->connect(actions);
  comparison_->connect(actions);
  match_->connect(actions);
  figures_->connect(actions);
  plots_->connect(actions);
  recording_->connect(actions);
  report_->connect(actions);
  sessions_->connect(actions);
  recent_->connect(actions);
  preferences_->connect(actions);
  plugins_->connect(actions, session_->plugins(),
                    [this](const std::string &title, const Error &error) { onFailed(title, error); });
  actions.open = [this](const ui::OpenRequest &request) { open(request); };
  actions.reload = [this] { loader_->reload(); };
  actions.saveLabels = [this](const std::filesystem::path &file) { images_->saveLabels(file); };
  actions.saveStatistics = [this](const std::filesystem::path &file) { images_->saveStatistics(file); };
  actions.closeImage = [this] { closeImage(); };
  actions.closeSimulation = [this] { closeSimulation(); };
  actions.surfaceExtensions = [this] { return listed(session_->meshFormats().writableExtensions()); };
  actions.unsaved = [this] { return unsaved(); };
  replay_->connect(actions);
  actions.beforeDraw = [this] {
    session_->plugins().syncScene();
    images_->followNode();
  };
  return actions;
}

void Workstation::run() {
  watchForInterrupt();
  // Called at least once a second.
  window_->closeWhen([this] {
    // Storing a state would change what is replayed.
    if (!replay_->isReplaying()) sessions_->autosaveIfDue();
    return wasInterrupted();
  });
  while (!window_->closeRequested()) {
    const bool showsNewData = window_->waitForFrame();
    // While a figure is drawn, all its views show the same moment.
    if (showsNewData && !figures_->isDrawing()) {
      session_->mainQueue().runFrame();
      simulation_->reportProblems();
    }
    // The state first: if the simulation is not moving, this frame is the last one, and its displacement is requested
    // after it.
    ui::SimulationView simulation = simulation_->view();
    simulation.recording = recording_->fileName();
    simulation.hasTimeline = recording_->hasTimeline();
    replay_->show(simulation);
    if (showsNewData && !figures_->isDrawing()) {
      showLatestResults();
      replay_->drawPicture();
    }
    if (showsNewData) figures_->draw(simulation);
    plots_->drawPicture(simulation);
    recent_->update();
    window_->drawFrame(*renderer_, simulation);
  }
  recording_->finish();
  report_->stop();
  sessions_->stop(wasInterrupted());
  recent_->stop();
  window_->writeAutomationState();
  session_->mainQueue().setWaker({});
}

/// Images are opened in the views, everything else becomes a simulation. Of several images the first is shown and the
/// others are overlaid on it as label maps.
void Workstation::open(const ui::OpenRequest &request) {
  recent_->onRequested(request);
  std::vector<std::filesystem::path> images, others;
  for (const std::filesystem::path &file : request.files) {
    std::error_code ignored;
    const FileKind kind = request.areLabels ? FileKind::image : kindOf(file, &session_->meshFormats());
    // A file of unknown kind does not prevent the others from being opened.
    if (kind == FileKind::unknown && std::filesystem::is_regular_file(file, ignored))
      onFailed("Could not open " + pathText(file.filename()), unknownKind(file, &session_->meshFormats()));
    else
      (kind == FileKind::image ? images : others).push_back(file);
  }
  const auto isAlone = [](const auto &file) { return isSessionPath(file) || isRecordingPath(file); };
  if (const auto saved = std::find_if(others.begin(), others.end(), isAlone); saved != others.end()) {
    if (request.files.size() > 1)
      return onFailed("Could not open " + pathText(saved->filename()),
                      {ErrorCode::usage, "is opened alone; accepted: one session or one recording"});
    if (isSessionPath(*saved)) return sessions_->open(*saved);
    // Work that is not saved is kept, as that before a timeline.
    return sessions_->isModified() ? replay_->openPast(*saved) : replay_->open(*saved);
  }
  if (!images.empty() && request.areLabels)
    images_->openLabels(images.front());
  else if (!images.empty())
    images_->open(images.front(), {images.begin() + 1, images.end()}, {}, 0, WorkstationImages::Segmentation::labels,
                  !others.empty());
  if (!others.empty()) loader_->open(others, request.meshUnit);
}

RecentFilesController::Shown Workstation::shownFiles() const {
  RecentFilesController::Shown shown;
  const bool hasImage = images_->hasImage();
  shown.others = loadedFiles_;
  if (hasImage) shown.others.push_back(images_->file());
  if (hasImage || session_->simulation() != nullptr) shown.session = sessions_->file();
  return shown;
}

/// What quitting would lose.
std::string Workstation::unsaved() {
  std::string text;
  const SessionController::Unsaved unsaved = sessions_->unsaved();
  const auto add = [&](const std::string &line) { text += (text.empty() ? "" : "\n") + line; };
  if (const scene::Simulation *simulation = session_->simulation(); unsaved.simulation && !replay_->isReplaying())
    add("The simulation, at t = " + formatNumber(std::round(1e3 * simulation->state().time_s) / 1e3) +
        " s, has changes that are not saved.");
  if (unsaved.measurements) add("The measurements are not saved.");
  if (unsaved.comparison) add("The position of the second scan is not saved.");
  if (unsaved.match) add("The values of the panel Match are not saved.");
  if (replay_->hasKept()) add("The simulation from before the timeline was shown is not saved.");
  if (unsaved.selection && !images_->isMaskSaved())
    add("What is picked in the image is not saved, and no body has been created of it.");
  for (const BackgroundJobs::Status &job : session_->jobs().running()) add("Still running: " + job.title + ".");
  return text;
}

std::string Workstation::whyNoMatch() const {
  if (replay_->isReplaying()) return ui::kReplayLocks;
  if (loader_->isLoading() || history_->isBusy()) return "another simulation is being built; try it again afterwards";
  return {};
}

void Workstation::onImageShown() {
  figures_->onImageChanged();
  render::Camera &camera = window_->camera();
  if (camera.upAxis != render::UpAxis::z) ui::viewOfImages(camera);
  window_->requestFit();
  warp_->request();
  sessions_->onImageShown();
}

void Workstation::closeImage() {
  recent_->beforeClosing();
  images_->close();
  window_->camera().upAxis = render::UpAxis::y;
  window_->requestFit();
}

void Workstation::closeSimulation() {
  recent_->beforeClosing();
  history_->clear();
  removeSimulation();
  sessions_->onClosed();
}

/// Image and labels are kept.
void Workstation::removeSimulation() {
  tools_.cancelActive();
  recording_->end("The simulation was closed.");
  replay_->end();
  report_->end();
  session_->closeSimulation();
  match_->onReplaced();
  measurements_->onRemoved();
  figures_->onRemoved();
  plots_->onRemoved();
  loadedFiles_.clear();
  warp_->setSettings({});
  images_->onBodiesRemoved();
  images_->showMissing({}, true);
  beginTissues({});
  warp_->request();
}

void Workstation::onBodiesJoined(bool isNew, bool hasReplaced) {
  if (isNew) replay_->end();
  if (isNew) simulation_->applyTargetRate();
  match_->onReplaced();
  measurements_->onBodiesChanged();
  sessions_->onMade(hasReplaced);
  report_->begin(false);
  if (isNew) loadedFiles_.clear();
  if (isNew) matchValues_.clear();
  // Bodies that existed before restart.
  const std::shared_ptr<const std::vector<TissueVoxels>> stay = isNew ? nullptr : tissueTable_->tracker().bodies();
  beginTissues(stay ? *stay : std::vector<TissueVoxels>());
  warp_->request();
}

void Workstation::onLoaded(const WorkstationLoader::Loaded &loaded) {
  if (!loaded.isReload) window_->requestFit();
  match_->onReplaced();
  const bool isUndo = loaded.session && !loaded.session->action.empty();
  if (!isUndo && !loaded.isReload) matchValues_.clear();
  checkSize(loaded, panels_);
  const scene::SceneImage image = loaded.image.value_or(scene::SceneImage{});
  warp_->setSettings(image);
  ui::ImageOptions options = images_->views().options();
  options.still = image.still;
  images_->views().setOptions(options);
  if (!loaded.session || !loaded.session->continuesFrom) images_->onBodiesRemoved();
  images_->showMissing(loaded.coverage, true);
  beginTissues(loaded.tissues);
  images_->showDisplacement(nullptr);
  if (loaded.image && !loaded.isReload && !loaded.isImageOpen)
    images_->open(image.file, image.labels, image.series, image.time, WorkstationImages::Segmentation::image, true);
  else
    warp_->request();
  figures_->onRemoved();
  plots_->onRemoved();
  simulation_->applyTargetRate();
  recording_->end("Another simulation is open.");
  const ReplayController::Present present = replay_->onLoaded(loaded.session);
  measurements_->onLoaded(loaded);
  const bool isPast = present == ReplayController::Present::replay && replay_->hasKept();
  if (present == ReplayController::Present::keptOne) recording_->onReturned();
  if (present == ReplayController::Present::replay)
    report_->end();
  else
    report_->begin(loaded.session && !loaded.session->saved.state.empty());
  // The past of the present simulation, and back from it: its file stays the same.
  if (isPast || present == ReplayController::Present::keptOne)
    sessions_->onReplaced();
  else
    sessions_->onLoaded(present == ReplayController::Present::other ? loaded.session : nullptr, loaded.notRestored);
  if (!isUndo && !isPast && present != ReplayController::Present::keptOne && !loaded.isImageOpen) history_->clear();
  loadedFiles_ = loaded.session ? std::vector<std::filesystem::path>() : loader_->files();
  if (loaded.isImageOpen && !loaded.session) sessions_->onMade(false);
  if (!std::exchange(playsWhenLoaded_, false)) return;
  present == ReplayController::Present::replay ? replay_->play(true)
                                               : session_->simulation()->transport(C3DE_TRANSPORT_PLAY);
}

/// Displacement and tissues are those of the present simulation, which has begun or changed.
void Workstation::beginTissues(std::vector<TissueVoxels> bodies) {
  warp_->begin();
  TissueTracker &tracker = tissueTable_->tracker();
  tracker.begin(std::move(bodies));
  tissueSurfaces_->rebuild(tracker.bodies());
}

/// Called before a frame. A snapshot that was skipped is requested again if no other follows.
void Workstation::showLatestResults() {
  bodyUpdates_->onFrame();
  TissueTracker &tracker = tissueTable_->tracker();
  warp_->showLatest();
  tissueTable_->update();
  measurements_->update();
  plots_->update();
  match_->update();
  tissueSurfaces_->update(tracker);
  scene::Simulation *simulation = session_->simulation();
  if ((warp_->isBehind() || tracker.isBehind()) && simulation && simulation->state().mode != C3DE_SIM_PLAYING)
    simulation->post([] {});
}

void Workstation::onFailed(const std::string &title, const Error &error) {
  const bool isCancelled = error.code == ErrorCode::cancelled;
  const std::string stays = session_ && session_->simulation() ? "\nWhat was open before stays as it is." : "";
  if (!isCancelled) log(LogLevel::error, title + ": " + error.message);
  panels_.notify(isCancelled ? C3DE_LOG_INFO : C3DE_LOG_ERROR, title, error.message + stays);
}

}  // namespace

int runWorkstation(const WorkstationOptions &options) {
  Workstation workstation;
  if (auto started = workstation.start(options); !started) return reportError(started.error());
  workstation.run();
  return wasInterrupted() ? kInterrupted : kDone;
}

}  // namespace c3de::app
