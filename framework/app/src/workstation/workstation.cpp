// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/imaging/reading.h"
#include "c3de/plugin_host/plugin_records.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/plain_words.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/session/body_creation.h"
#include "c3de/session/displacement_sampler.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/fixed_region_rule.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/tissue_tracker.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/file_browser.h"
#include "c3de/ui/tissue_table.h"
#include "c3de/ui/view_controller.h"
#include "c3de/ui/workstation_window.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "workstation/plugin_choices.h"
#include "workstation/tissue_presenter.h"
#include "workstation/workstation_export.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"
#include "workstation/workstation_screenshot.h"

namespace c3de::app {
namespace {

std::string keyOf(ui::Command command) {
  const ui::CommandInfo &info = ui::commandInfo(command);
  return ui::keyText(info.key, info.modifiers);
}

constexpr double kSmallOrgan_mm = 20.0, kLargeOrgan_mm = 5000.0;

/// One run of the window. Members are destroyed from the last to the first: the session releases its plugins while
/// registries, renderer and graphics context still exist.
class Workstation {
 public:
  [[nodiscard]] Expected<void> start(const WorkstationOptions &options);
  void run();

 private:
  void open(const ui::OpenRequest &request);
  [[nodiscard]] ui::WindowActions actions();
  [[nodiscard]] std::string proposedName(ui::Command exported) const;
  [[nodiscard]] std::string unsaved() const;
  [[nodiscard]] ui::AboutText about() const;
  [[nodiscard]] ui::SimulationView simulationView();
  [[nodiscard]] std::string meshExtensions() const;
  void showPluginProblems();
  void saveScreenshot();
  void watchForFailure();
  void watchForStepsGivenUp();
  void onImageShown();
  void requestWarp();
  [[nodiscard]] FixedRegions fixedRegions();
  void requestFields();
  void fillTissueTable();
  void showTissues();
  void makeTissueSurfaces();
  void applyLatestWarp();
  void closeSimulation();
  void onBodiesReady(const BodyCreation::Result &result);
  void createScanBody(const std::string &scene);
  void onLoaded(const WorkstationLoader::Loaded &loaded);
  void checkSize(const std::string &unit, double size_mm);
  void onFailed(const std::string &title, const Error &error);

  std::optional<CrashJournal> journal_;
  std::shared_ptr<plugin_host::PluginRecords> records_;
  std::vector<std::string> offAtStart_;  ///< ids of plugins
  registry::PanelRegistry panels_;
  registry::ParameterRegistry parameters_;
  registry::ToolRegistry tools_;
  registry::EditList edits_;
  registry::CommandRegistry commands_;
  std::unique_ptr<ui::WorkstationWindow> window_;
  std::unique_ptr<render::Renderer> renderer_;
  std::unique_ptr<WorkstationLoader> loader_;           ///< used by the session's jobs until they end
  std::unique_ptr<BodyCreation> bodyCreation_;          ///< used by the session's jobs until they end
  std::unique_ptr<WorkstationImages> images_;           ///< used by the session's jobs until they end
  DisplacementSampler warp_;                            ///< used by the simulation's thread
  TissueTracker tissues_{[this] { window_->wake(); }};  ///< used by the simulation's thread
  Handle surfacesJob_;
  std::uint64_t surfacesSerial_ = 0;
  ui::TissueTable tissueTable_;
  std::shared_ptr<const std::vector<TissueMotion>> tissuesShown_;
  std::shared_ptr<const std::vector<TissueVoxels>> tissuesOf_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<TissuePresenter> tissueSurfaces_;  ///< uses the session's tree
  scene::SceneImage image_;                          ///< how images deform with the simulation
  using FixedRegionRequest = std::tuple<scene::SceneFixedRegions, std::shared_ptr<const scene::StoredImage>,
                                        std::shared_ptr<const scene::StoredLabels>>;
  RequestedFields fieldsAsked_;
  FixedRegionRequest fixedRegionRequest_;  ///< the fixed regions when the warp was requested
  bool playsWhenLoaded_ = false;
  bool hasReportedFailure_ = false;
  std::uint64_t stepsGivenUp_ = 0;
  std::string activity_;  ///< of the last step that took long
  double targetRate_ = 1.0;
};

Expected<void> Workstation::start(const WorkstationOptions &options) {
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

  SessionOptions sessionOptions = options.session;
  sessionOptions.renderer = renderer_.get();
  sessionOptions.panels = &panels_;
  panels_.setWording([this](const std::string &text) { return registry::plainWords(text, parameters_); });
  sessionOptions.parameters = &parameters_;
  sessionOptions.tools = &tools_;
  sessionOptions.edits = &edits_;
  commands_.setProgramKeys(&ui::programCommandOf);
  sessionOptions.commands = &commands_;
  if (auto journal = beginJournal(sessionOptions)) journal_.emplace(std::move(*journal));
  sessionOptions.loadRules.hasWindow = true;
  askAboutCrashes(*window_, *renderer_, sessionOptions.loadRules);
  records_ = sessionOptions.loadRules.records;
  offAtStart_ = records_->allOff();
  auto session = Session::create(sessionOptions);
  if (!session) return tl::unexpected(session.error());
  session_ = std::move(*session);
  session_->setPublishedHook([this](const scene::Simulation &simulation) {
    tissues_.onPublished(simulation, warp_.onPublished(simulation), warp_.wanted());
  });

  playsWhenLoaded_ = options.play;
  loader_ = std::make_unique<WorkstationLoader>(
      *session_,
      WorkstationLoader::Events{[this](const WorkstationLoader::Loaded &loaded) { onLoaded(loaded); },
                                [this](const std::string &title, const Error &error) { onFailed(title, error); }});
  session_->mainQueue().setWaker([window = window_.get()] { window->wake(); });
  bodyCreation_ = std::make_unique<BodyCreation>(
      *session_,
      BodyCreation::Events{[this](const BodyCreation::Result &result) { onBodiesReady(result); },
                           [this](const std::string &title, const Error &error) { onFailed(title, error); }});
  images_ = std::make_unique<WorkstationImages>(
      *session_, *renderer_, panels_,
      WorkstationImages::Events{
          [this] { onImageShown(); }, [this] { warp_.want(false, image_.rim_mm); },
          [this](const std::string &title, const Error &error) { onFailed(title, error); },
          [this](std::vector<segmentation::BodyRequest> requests) { bodyCreation_->createBodies(std::move(requests)); },
          [this](const std::string &scene) { createScanBody(scene); }, [this] { closeSimulation(); }});
  tissueSurfaces_ = std::make_unique<TissuePresenter>(*renderer_, session_->sceneGraph());
  window_->connect({&panels_, &tools_, &parameters_, &session_->sceneGraph(), &session_->jobs(), &images_->views(),
                    &images_->workflow(), &images_->scanBody(), &tissueTable_, &edits_, &commands_,
                    [this] { return meshExtensions(); }},
                   actions());
  tools_.setMarkedPoint([this] {
    const ui::ImageViews &views = images_->views();
    return views.image() ? views.crossHair() : window_->camera().focus;
  });
  window_->setAbout(about());
  showPluginProblems();
  if (sessionOptions.loadRules.isSafeMode)
    panels_.notify(C3DE_LOG_INFO, "Safe mode", "Only the plugins that came with the program were looked at.");
  if (!options.notice.empty()) {
    log(LogLevel::warn, options.notice);
    panels_.notify(C3DE_LOG_INFO, "Another scene than usual", options.notice);
  }
  open({options.files, options.meshUnit, false});
  return {};
}

void Workstation::run() {
  watchForInterrupt();
  window_->closeWhen(wasInterrupted);
  while (!window_->closeRequested()) {
    const bool showsNewData = window_->waitForFrame();
    if (showsNewData) {
      session_->mainQueue().runFrame();
      watchForFailure();
      watchForStepsGivenUp();
    }
    // The state first: if the simulation is not moving, this frame is the last one, and its displacement is requested
    // after it.
    const ui::SimulationView simulation = simulationView();
    if (showsNewData) applyLatestWarp();
    window_->drawFrame(*renderer_, simulation);
  }
  window_->writeAutomationState();
  session_->mainQueue().setWaker({});
}

/// Images are opened in the views, everything else becomes a simulation. Of several images the first is shown and the
/// others are overlaid on it as label maps.
void Workstation::open(const ui::OpenRequest &request) {
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
  if (!images.empty() && request.areLabels)
    images_->openLabels(images.front());
  else if (!images.empty())
    images_->open(images.front(), {images.begin() + 1, images.end()}, {}, 0, WorkstationImages::Segmentation::labels,
                  !others.empty());
  if (!others.empty()) loader_->open(others, request.meshUnit);
}

std::string Workstation::meshExtensions() const {
  std::string text;
  for (const std::string &extension : session_->meshFormats().extensions())
    text += (text.empty() ? "" : ";") + extension.substr(1);
  return text;
}

ui::WindowActions Workstation::actions() {
  ui::WindowActions actions;
  actions.open = [this](const ui::OpenRequest &request) { open(request); };
  actions.closeImage = [this] {
    images_->close();
    window_->camera().upAxis = render::UpAxis::y;
    window_->requestFit();
  };
  actions.closeSimulation = [this] { closeSimulation(); };
  actions.reload = [this] { loader_->reload(); };
  actions.simulators = [this] {
    std::vector<ui::SimulatorChoice> choices;
    for (const SimulatorIdentity &one : session_->simulators())
      choices.push_back({one.classId, one.label, one.plugin, one.classId == session_->simulatorClass()});
    return choices;
  };
  actions.chooseSimulator = [this](const std::string &id) { session_->setSimulatorClass(id); };
  actions.transport = [this](std::uint32_t action) {
    if (scene::Simulation *simulation = session_->simulation()) simulation->transport(action);
  };
  actions.setTargetRate = [this](double rate) {
    targetRate_ = rate;
    if (scene::Simulation *simulation = session_->simulation()) simulation->setTargetRate(rate);
  };
  actions.plugins = [this] { return pluginEntries(session_->plugins(), *records_, offAtStart_); };
  actions.switchPlugin = [this](const std::string &id, bool isOn) {
    if (const auto kept = records_->setOff(id, !isOn); !kept)
      onFailed("The choice holds for this run only", kept.error());
  };
  actions.screenshot = [this] { saveScreenshot(); };
  const auto tell = [this](const Expected<std::string> &written) {
    if (written)
      panels_.notify(C3DE_LOG_INFO, "Exported", *written);
    else
      onFailed("The export could not be written", written.error());
  };
  actions.surfaceExtensions = [this] {
    std::string all;
    for (const std::string &extension : session_->meshFormats().writableExtensions())
      all += (all.empty() ? "" : ";") + extension.substr(1);
    return all;
  };
  actions.exportSurface = [this, tell](const std::filesystem::path &file) {
    exportPresentSurface(*session_, file, tell);
  };
  actions.exportFrame = [this, tell](const std::filesystem::path &file) { exportPresentFrame(*session_, file, tell); };
  actions.saveState = [this](const std::filesystem::path &file) {
    savePresentState(*session_, file, [this](const Expected<std::string> &written) {
      if (written)
        panels_.notify(C3DE_LOG_INFO, "Saved", *written);
      else
        onFailed("The state could not be saved", written.error());
    });
  };
  actions.loadState = [this](const std::filesystem::path &file) {
    goToStateOf(*session_, file, [this](const Expected<std::string> &gone) {
      if (gone)
        panels_.notify(C3DE_LOG_INFO, "Loaded", *gone);
      else
        onFailed("The state could not be loaded, and nothing has changed", gone.error());
    });
  };
  const auto exportImage = [this, tell](const ImageExport &wanted) {
    const FixedRegions still = images_->views().image() ? fixedRegions() : FixedRegions{};
    // Shares ownership of the object that contains the label map.
    const std::shared_ptr<const imaging::LabelMap> labels =
        still.labels ? std::shared_ptr<const imaging::LabelMap>(still.labels, &still.labels->map) : nullptr;
    const segmentation::ScanBody::Sources &open = images_->scanBody().sources();
    exportPresentImage(
        *session_,
        {images_->views().sharedImage(), open.layers, !open.layers.empty() && open.imageFile == open.labelFile},
        {image_.rim_mm, still.rule, labels, still.tissues}, wanted, tell);
  };
  actions.exportImage = [exportImage](const std::filesystem::path &file) { exportImage({file, {}, {}}); };
  actions.exportLabels = [exportImage](const std::filesystem::path &file) { exportImage({{}, {}, file}); };
  actions.exportDisplacement = [exportImage](const std::filesystem::path &file) { exportImage({{}, file, {}}); };
  actions.exportTissues = [this, tell](const std::filesystem::path &file) {
    exportPresentTissues(*session_, tissues_.bodies(), file, tell);
  };
  actions.saveScanScene = [this](const std::filesystem::path &file) {
    const auto written = writeWholeFile(file, images_->scanBody().sceneText(file.parent_path()));
    if (written)
      panels_.notify(C3DE_LOG_INFO, "Saved", "The scene of the scan: " + pathText(file));
    else
      onFailed("The scene could not be saved", written.error());
  };
  actions.proposeName = [this](ui::Command exported) { return proposedName(exported); };
  actions.unsaved = [this] { return unsaved(); };
  actions.beforeDraw = [this] {
    session_->plugins().syncScene();
    images_->followNode();
  };
  return actions;
}

/// Named after the image or the simulation, what is written of it, and its time.
std::string Workstation::proposedName(ui::Command exported) const {
  const scene::StoredImage *image = images_->views().image();
  const scene::Node *node = session_->sceneGraph().find(session_->simulationNode());
  const bool isOfImage = exported == ui::Command::exportImage || exported == ui::Command::exportLabels ||
                         exported == ui::Command::exportDisplacement;
  std::string name = isOfImage && image ? imaging::nameFromFile(pathFromText(image->name))
                     : node             ? node->name
                                        : std::string();
  if (name.empty()) name = isOfImage ? "image" : "bodies";
  name = ui::fileNamePart(name);
  if (exported == ui::Command::exportImage) name += "-deformed";
  if (exported == ui::Command::exportLabels) name += "-labels-deformed";
  if (exported == ui::Command::exportDisplacement) name += "-displacement";
  if (exported == ui::Command::exportTissues) name += "-tissues";
  if (scene::Simulation *simulation = session_->simulation())
    name += fmt::format("-{:.3f}s", simulation->state().time_s);
  return name;
}

/// What quitting would lose.
std::string Workstation::unsaved() const {
  std::string text;
  const auto add = [&](const std::string &line) { text += (text.empty() ? "" : "\n") + line; };
  if (const scene::Simulation *simulation = session_->simulation(); simulation && simulation->state().steps > 0)
    add("The simulation has run to t = " + formatNumber(std::round(1e3 * simulation->state().time_s) / 1e3) +
        " s. Its state is lost; File > Export… writes it.");
  if (const segmentation::SegmentationWorkflow &workflow = images_->workflow();
      workflow.mask().mask() || !workflow.pickedLabels().empty())
    add("No body has been created of what is picked in the image.");
  for (const BackgroundJobs::Status &job : session_->jobs().running()) add("Still running: " + job.title + ".");
  return text;
}

ui::AboutText Workstation::about() const {
  ui::AboutText about;
  about.version =
      "C3DE " C3DE_VERSION ", plugin ABI " + std::to_string(C3DE_ABI_MAJOR) + "." + std::to_string(C3DE_ABI_MINOR);
  about.graphics = renderer_->description();
  return about;
}

ui::SimulationView Workstation::simulationView() {
  ui::SimulationView view;
  view.transport.size = sizeof view.transport;
  const scene::Simulation *simulation = session_->simulation();
  if (!simulation) return view;
  view.exists = true;
  view.transport = simulation->state();
  if (view.isLongStep()) {
    // Between two steps the reason of the last one is kept.
    if (std::string now = simulation->activity(); !now.empty()) activity_ = std::move(now);
    view.activity = activity_;
  }
  if (const scene::Node *node = session_->sceneGraph().find(session_->simulationNode())) view.title = node->name;
  return view;
}

void Workstation::showPluginProblems() {
  for (const plugin_host::PluginInfo &plugin : session_->plugins().plugins())
    if (plugin.state == plugin_host::PluginState::refused)
      panels_.notify(C3DE_LOG_WARN, "Plugin " + pathText(plugin.path.filename()) + " was refused", plugin.reason);
}

void Workstation::saveScreenshot() {
  const auto file = saveViewScreenshot(*renderer_, window_->camera(), window_->viewWidth(), window_->viewHeight());
  if (file)
    panels_.notify(C3DE_LOG_INFO, "Screenshot saved", pathText(*file));
  else
    onFailed("The screenshot could not be saved", file.error());
}

/// A failed simulation is reported once, with the remedy.
void Workstation::watchForFailure() {
  scene::Simulation *simulation = session_->simulation();
  const bool hasFailed = simulation && simulation->state().mode == C3DE_SIM_FAILED;
  if (hasFailed && !hasReportedFailure_) {
    const std::string why = simulation->failure();
    log(LogLevel::error, "the simulation stopped: " + why);
    panels_.notify(C3DE_LOG_ERROR, "The simulation stopped",
                   why + "\nThe last good state is shown. Reset (" + keyOf(ui::Command::reset) +
                       ") goes back to the initial state.",
                   {}, registry::About::simulation);
  }
  hasReportedFailure_ = hasFailed;
}

/// An abandoned step has paused the simulation: reports why, and what would help.
void Workstation::watchForStepsGivenUp() {
  const scene::Simulation *simulation = session_->simulation();
  const scene::Simulation::AbortedSteps now =
      simulation ? simulation->abortedSteps() : scene::Simulation::AbortedSteps();
  if (now.steps > stepsGivenUp_)
    panels_.notify(C3DE_LOG_WARN, "Paused: a step took too long",
                   now.why + "\n" + keyOf(ui::Command::playPause) + " tries it again, " + keyOf(ui::Command::reset) +
                       " goes back to the initial state.",
                   {}, registry::About::simulation);
  stepsGivenUp_ = now.steps;
}

/// With a wrong unit an organ has the size of a house or of a grain, and all subsequent results are wrong.
void Workstation::checkSize(const std::string &unit, double size_mm) {
  if (unit.empty() || !(size_mm > 0.0)) return;
  if (size_mm < kSmallOrgan_mm || size_mm > kLargeOrgan_mm)
    panels_.notify(C3DE_LOG_WARN, "Is the unit right?",
                   "The numbers in the file were read as " + unit + ". That makes what is shown " +
                       formatNumber(std::round(size_mm * 10.0) / 10.0) +
                       " mm across. File > Open mesh… asks for another unit; on the command line it is --unit.",
                   {}, registry::About::simulation);
}

void Workstation::onImageShown() {
  render::Camera &camera = window_->camera();
  if (camera.upAxis != render::UpAxis::z) ui::viewOfImages(camera);
  window_->requestFit();
  requestWarp();
}

/// Image and labels are kept.
void Workstation::closeSimulation() {
  tools_.cancelActive();
  session_->closeSimulation();
  image_ = {};
  images_->onBodiesRemoved();
  images_->showMissing({}, true);
  warp_.begin();
  tissues_.begin({});
  makeTissueSurfaces();
  requestWarp();
}

void Workstation::onBodiesReady(const BodyCreation::Result &result) {
  scene::Simulation *simulation = session_->simulation();
  if (result.isNew) {
    simulation->setTargetRate(targetRate_);
    images_->onBodiesRemoved();
  }
  images_->onBodiesReady(result.created);
  images_->showMissing(result.coverage, result.isNew);
  tools_.cancelActive();  // the simulation restarts, and what a tool held is lost
  warp_.begin();
  // Bodies that existed before restart.
  const std::shared_ptr<const std::vector<TissueVoxels>> stay = result.isNew ? nullptr : tissues_.bodies();
  tissues_.begin(stay ? *stay : std::vector<TissueVoxels>());
  makeTissueSurfaces();
  requestWarp();
  simulation->transport(C3DE_TRANSPORT_PLAY);
  const bool isOne = result.created.size() == 1;
  const std::string it = isOne ? "it" : "them";
  panels_.notify(C3DE_LOG_INFO, (isOne ? "Body created: " : "Bodies created: ") + namesOf(result.created),
                 result.isNew
                     ? "Pinch " + it +
                           " in the 3D view or in a slice (P). Gravity is off, because the scan shows the organ" +
                           (isOne ? "" : "s") + " in balance with it; it is in the panel of the simulation."
                     : std::string(isOne ? "It" : "They") + " was added to the present simulation, which restarts.",
                 {}, registry::About::simulation);
  if (!result.notTried.empty())
    panels_.notify(C3DE_LOG_INFO, "Cancelled",
                   namesOf(result.notTried) + (result.notTried.size() == 1 ? " was" : " were") + " not created.");
  std::string reasons;
  for (const auto &[name, error] : result.failed) reasons += error.message + "\n";
  if (reasons.empty()) return;
  log(LogLevel::error, "bodies that could not be created: " + reasons);
  panels_.notify(
      C3DE_LOG_ERROR,
      result.failed.size() == 1 ? result.failed.front().first + " could not be created"
                                : std::to_string(result.failed.size()) + " bodies could not be created",
      reasons + (result.failed.size() == 1 ? "It stays" : "They stay") + " picked; the others were created.");
}

void Workstation::createScanBody(const std::string &scene) {
  loader_->openText(scene, [this](const Expected<void> &made) {
    const bool isShown = images_->scanBody().finished(made);
    const std::string title = made ? "Scan body created" : "Could not create the body of the scan";
    // The dialog shows it.
    if (isShown) return log(LogLevel::error, title + ": " + made.error().message);
    if (!made) return onFailed(title, made.error());
    tools_.cancelActive();
    session_->simulation()->transport(C3DE_TRANSPORT_PLAY);
    panels_.notify(
        C3DE_LOG_INFO, title,
        "Pull it in a slice or in the 3D view (pinch, P). It is in balance where it lies; another gravity is "
        "in the panel of the simulation.",
        {}, registry::About::simulation);
  });
}

/// The image deforms with the bodies while both exist.
void Workstation::requestWarp() {
  scene::Simulation *simulation = session_->simulation();
  const bool wanted = image_.warp && simulation && images_->views().image() && supportsFills(simulation->table());
  const ui::ImageViews &views = images_->views();
  fixedRegionRequest_ = {views.options().still, views.sharedImage(), views.sharedLabels()};
  warp_.want(wanted, image_.rim_mm, wanted ? views.image()->volume.geometry : imaging::VolumeGeometry{},
             wanted ? fixedRegions() : FixedRegions{});
  if (!wanted) return images_->showDisplacement(nullptr);
  simulation->post([] {});  // publishes once more
}

/// Fixed regions of the image, as set in the panel.
FixedRegions Workstation::fixedRegions() {
  const ui::ImageViews &views = images_->views();
  FixedRegions places{views.sharedImage(), views.sharedLabels(), {}, tissues_.bodies()};
  auto rule = fixedRegionRuleOf(views.options().still, places.image->volume,
                                places.labels ? &places.labels->map : nullptr, session_->materials());
  if (rule)
    places.rule = std::move(*rule);
  else
    onFailed("Everything in the image moves with the bodies", rule.error());
  return places;
}

/// Fields of the tissue, while they are visible.
void Workstation::requestFields() {
  ui::ImageViews &views = images_->views();
  std::vector<std::pair<std::string, std::string>> offered;
  for (const PointField &field : warp_.offered()) offered.emplace_back(field.name, field.unit);
  views.setOfferedFields(std::move(offered));
  images_->followOverlay();
  const ui::ImageOptions &options = views.options();
  const RequestedFields wanted{views.wantsFields(),
                               options.overlay == ui::Overlay::field ? options.overlayField : std::string()};
  if (wanted == fieldsAsked_) return;
  fieldsAsked_ = wanted;
  warp_.requestFields(wanted);
  scene::Simulation *simulation = session_->simulation();
  const imaging::DisplacementGrid *shown = views.displacement();
  const bool isThere =
      shown && shown->field(imaging::kVolumeRatio) && (wanted.name.empty() || shown->field(wanted.name));
  if (wanted.any && simulation && !isThere) simulation->post([] {});  // publishes once more
}

/// Motion of the labels, while the table is visible.
void Workstation::fillTissueTable() {
  tissues_.want(tissueTable_.isShown);
  const auto bodies = tissues_.bodies();
  const auto newest = tissues_.newest();
  if (bodies == tissuesOf_ && newest == tissuesShown_) return;
  tissuesOf_ = bodies;
  tissuesShown_ = newest;
  tissueTable_.rows.clear();
  if (!bodies) return;
  constexpr double kMillilitres = 1e6, kMillimetres = 1e3;
  const scene::StoredLabels *shown = images_->views().labels();
  for (std::size_t b = 0; b < bodies->size(); ++b) {
    const TissueVoxels &places = (*bodies)[b];
    for (std::size_t i = 0; i < places.labels.size(); ++i) {
      const LabelVoxels &label = places.labels[i];
      if (label.voxels == 0) continue;
      ui::TissueRow row;
      const scene::SceneTissue tissue = places.tissueAt(label.tissue);
      row.label = label.value == 0 ? "background" : label.name;
      row.tissue = tissue.preset;
      row.isRigid = tissue.isRigid;
      for (std::size_t k = 0; shown && k < shown->map.labels.size(); ++k)
        if (const auto &one = shown->map.labels[k]; one.value == label.value && one.name == label.name) {
          const render::Colour colour = render::displayColour(one.colour);
          row.colour = {colour[0], colour[1], colour[2]};
        }
      row.reference_ml = 1e-3 * places.voxel_mm3 * static_cast<double>(label.voxels);
      if (newest && b < newest->size() && i < (*newest)[b].labels.size())
        if (const LabelMotion &motion = (*newest)[b].labels[i]; motion.isKnown()) {
          row.reference_ml = kMillilitres * motion.reference_m3;
          row.motion = {kMillilitres * motion.end_m3, kMillimetres * motion.meanDisplacement_m(),
                        kMillimetres * motion.largestDisplacement_m, motion.minJ};
        }
      tissueTable_.rows.push_back(std::move(row));
    }
  }
}

/// Surfaces of bodies of many tissues, built in a background job: the simulation has begun.
void Workstation::makeTissueSurfaces() {
  tissueSurfaces_->forget();
  const std::uint64_t serial = ++surfacesSerial_;
  if (!surfacesJob_.isNull()) session_->jobs().cancel(std::exchange(surfacesJob_, {}));
  const std::shared_ptr<const std::vector<TissueVoxels>> bodies = tissues_.bodies();
  if (!bodies) return;
  const auto made = std::make_shared<std::vector<TissueSurface>>();
  surfacesJob_ = session_->jobs().submit(
      kJobOwner, "Surfaces of tissues",
      [bodies, made](const ProgressFn &progress) -> Expected<void> {
        auto surfaces = tissueSurfaces(*bodies, progress);
        if (!surfaces) return tl::unexpected(surfaces.error());
        *made = std::move(*surfaces);
        return {};
      },
      [this, serial, made](const Expected<void> &result) {
        if (serial != surfacesSerial_) return;
        surfacesJob_ = {};
        if (!result) return;  // cancelled: the body is shown without them
        tissueSurfaces_->show(made, session_->simulationNode());
      });
}

/// Positions of the tissue surfaces, while the tree shows one that moves.
void Workstation::showTissues() {
  tissueSurfaces_->followTree();
  tissues_.follow(tissueSurfaces_->seen());
  tissueSurfaces_->place(tissues_.places());
}

/// Called before a frame, so that its texts agree with its slices.
void Workstation::applyLatestWarp() {
  const ui::ImageViews &views = images_->views();
  if (warp_.wanted() &&
      fixedRegionRequest_ != FixedRegionRequest{views.options().still, views.sharedImage(), views.sharedLabels()})
    requestWarp();
  if (auto newest = warp_.take()) images_->showDisplacement(std::move(newest));
  requestFields();
  fillTissueTable();
  showTissues();
  scene::Simulation *simulation = session_->simulation();
  if ((warp_.isBehind() || tissues_.isBehind()) && simulation && simulation->state().mode != C3DE_SIM_PLAYING)
    simulation->post([] {});
}

void Workstation::onLoaded(const WorkstationLoader::Loaded &loaded) {
  if (!loaded.isReload) window_->requestFit();
  checkSize(loaded.unit, loaded.size_mm);
  image_ = loaded.image.value_or(scene::SceneImage{});
  ui::ImageOptions options = images_->views().options();
  options.still = image_.still;
  images_->views().setOptions(options);
  images_->onBodiesRemoved();
  images_->showMissing(loaded.coverage, true);
  warp_.begin();
  tissues_.begin(loaded.tissues);
  makeTissueSurfaces();
  images_->showDisplacement(nullptr);
  if (loaded.image && !loaded.isReload && !loaded.isImageOpen)
    images_->open(loaded.image->file, loaded.image->labels, loaded.image->series, loaded.image->time,
                  WorkstationImages::Segmentation::image, true);
  else
    requestWarp();
  scene::Simulation *simulation = session_->simulation();
  simulation->setTargetRate(targetRate_);
  if (std::exchange(playsWhenLoaded_, false)) simulation->transport(C3DE_TRANSPORT_PLAY);
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
