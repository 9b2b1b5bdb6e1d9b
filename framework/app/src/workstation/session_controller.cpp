// SPDX-License-Identifier: Apache-2.0
#include "workstation/session_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/file_path.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/session/embedded_files.h"
#include "c3de/ui/file_browser.h"
#include "workstation/measurement_controller.h"
#include "workstation/workstation_export.h"

namespace c3de::app {
namespace {

std::filesystem::path recoveryFolder() { return userDataDirectory() / "recovery"; }

std::string stepText(std::uint64_t steps, double time_s) {
  return "step " + std::to_string(steps) +
         (time_s > 0.0 ? ", t = " + formatNumber(std::round(1e3 * time_s) / 1e3) + " s" : "");
}

/// @param time  ISO 8601, UTC
std::string timeText(std::string time) {
  constexpr std::size_t kToMinutes = 16;
  if (time.size() < kToMinutes || time[10] != 'T') return time;
  time[10] = ' ';
  time.resize(kToMinutes);
  return time + " UTC";
}

}  // namespace

SessionController::SessionController(Parts parts)
    : parts_(std::move(parts)), missing_({parts_.session, parts_.failed,
                                          [this](const MissingFilesController::Opened &opened) { build(opened); }}),
      recovery_(recoveryFolder(), [this](const Error &error) {
        parts_.session.mainQueue().post([this, error] {
          log(LogLevel::warn, "autosave failed: " + error.message);
          parts_.panels.notify(C3DE_LOG_WARN, "Autosave failed", error.message + "\nSave the session to keep it.");
        });
      }) {}

void SessionController::connect(ui::WindowActions &actions) {
  actions.saveSession = [this](const std::filesystem::path &file, std::function<void()> saved) {
    save(file, embedding_, std::move(saved));
  };
  actions.saveSessionWithFiles = [this](const std::filesystem::path &file) { save(file, Embedding::all, {}); };
  actions.measureSession = [this](std::function<void(const std::string &)> measured) { measure(std::move(measured)); };
  actions.sessionFile = [this] { return file_; };
  actions.title = [this] { return title(); };
}

SessionController::Baseline SessionController::present() const {
  scene::Simulation *simulation = parts_.session.simulation();
  const std::uint64_t measurements = parts_.measurements.revision();
  const segmentation::SegmentationWorkflow &workflow = parts_.images.workflow();
  const bool isPicked = workflow.mask().mask() || (!workflow.mask().isBusy() && !workflow.pickedLabels().empty());
  const std::uint64_t selection = isPicked ? workflow.mask().revision() : 0;
  const std::uint64_t comparison = parts_.comparison.revision();
  const std::uint64_t match = parts_.match.revision();
  if (simulation == nullptr) return {0, 0, 0, measurements, selection, comparison, match};
  return {serial_, parts_.session.changes()->count(), simulation->state().steps, measurements, selection, comparison,
          match};
}

SessionController::Unsaved SessionController::unsaved() const {
  const Baseline now = present(), saved = baseline_.value_or(Baseline{});
  Unsaved out;
  if (parts_.session.simulation() != nullptr)
    out.simulation =
        !baseline_ || saved.simulation != now.simulation || saved.changes != now.changes || saved.steps != now.steps;
  if (baseline_ || !parts_.measurements.set().isEmpty()) out.measurements = saved.measurements != now.measurements;
  out.selection = saved.selection != now.selection;
  out.comparison = saved.comparison != now.comparison && !parts_.comparison.isRestoring();
  out.match = saved.match != now.match;
  return out;
}

std::string SessionController::title() const {
  std::string name = pathText(file_.filename());
  if (name.empty())
    if (const scene::Node *node = parts_.session.sceneGraph().find(parts_.session.simulationNode())) name = node->name;
  if (name.empty())
    if (const scene::StoredImage *image = parts_.images.views().image()) name = image->name;
  if (name.empty()) return "C3DE";
  return name + (isModified() ? "*" : "") + " - C3DE";
}

ShownView SessionController::shownView() const {
  ShownView shown;
  const ui::ImageViews &views = parts_.images.views();
  if (views.image() != nullptr) {
    shown.image = parts_.images.file();
    shown.labels = parts_.images.labelFiles();
    shown.view.series = parts_.images.series();
    shown.view.time = views.image()->time;
    shown.view.crossHair_mm = views.crossHair();
    shown.view.window = views.options().windowLevel.window;
    shown.view.level = views.options().windowLevel.level;
    if (const auto second = parts_.comparison.shown()) {
      shown.comparison = second->file;
      shown.view.comparison = second->saved;
    }
  }
  if (const segmentation::Selection picked = parts_.images.workflow().selection(); !picked.isEmpty()) {
    shown.mask = picked.mask;
    shown.view.selection =
        SavedSelection{{}, {picked.labels.begin(), picked.labels.end()}, picked.name, picked.low, picked.high};
  }
  if (parts_.match.areSet()) shown.view.match = savedOf(parts_.match.form);
  if (parts_.measurements.revision() != 0) shown.view.measurements = savedOf(parts_.measurements.set());
  const render::Camera &camera = parts_.window.camera();
  shown.view.camera = SessionView::CameraPose{camera.focus, camera.yaw, camera.pitch, camera.distance};
  return shown;
}

void SessionController::capture(std::function<void(Captured)> done) {
  Session &session = parts_.session;
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr) return done(std::make_shared<Expected<CapturedState>>(CapturedState{}));
  const auto identity = presentSimulator(session);
  if (!identity) return done(std::make_shared<Expected<CapturedState>>(tl::unexpected(identity.error())));
  simulation->post([&session, simulation, changes = session.changes(), identity = *identity, done = std::move(done)] {
    Expected<CapturedState> state;
    try {
      state = captureState(session, simulation->object(), identity, *changes);
    } catch (const std::exception &error) {
      state = fail(ErrorCode::internal, error.what());
    }
    const auto captured = std::make_shared<Expected<CapturedState>>(std::move(state));
    session.mainQueue().post([captured, done] { done(captured); });
  });
}

void SessionController::measure(std::function<void(const std::string &)> measured) {
  const std::shared_ptr<ChangeLog> changes = parts_.session.changes();
  const ShownView shown = shownView();
  std::vector<std::filesystem::path> files = shown.labels;
  if (!shown.image.empty()) files.push_back(shown.image);
  if (!shown.comparison.empty()) files.push_back(shown.comparison);
  const auto sum = std::make_shared<FileStamp>();
  (void)parts_.session.jobs().submit(
      kJobOwner, "Counting the files of the session",
      [sum, files,
       source = changes ? changes->source() : SimulationSource()](const ProgressFn &progress) -> Expected<void> {
        const auto counted = stampOfFiles(source, files, progress);
        if (!counted) return tl::unexpected(counted.error());
        *sum = *counted;
        return {};
      },
      [this, sum, measured = std::move(measured)](const Expected<void> &result) {
        if (!result) return parts_.failed("The session cannot contain its files", result.error());
        measured(fmt::format("{} file{}, {} before compression", sum->files, sum->files == 1 ? "" : "s",
                             ui::sizeText(sum->bytes)));
      });
}

void SessionController::save(const std::filesystem::path &file, Embedding embedding, std::function<void()> saved) {
  if (isSaving_)
    return parts_.failed("The session could not be saved", {ErrorCode::state, "another save is in progress"});
  isSaving_ = true;
  capture([this, file, embedding, saved = std::move(saved), baseline = present(),
           shown = shownView()](const Captured &captured) {
    isSaving_ = false;
    if (!*captured) return parts_.failed("The session could not be saved", captured->error());
    write(file, embedding, captured, baseline, shown, saved);
  });
}

void SessionController::write(const std::filesystem::path &file, Embedding embedding, const Captured &captured,
                              const Baseline &baseline, const ShownView &shown, const std::function<void()> &saved) {
  Baseline written = baseline;
  written.steps = (*captured)->steps;
  isSaving_ = true;
  (void)parts_.session.jobs().submit(
      kJobOwner, "Saving " + pathText(file.filename()),
      [captured, shown, file, embedding, references = references_,
       foreign = foreign_](const ProgressFn &progress) -> Expected<void> {
        auto session =
            sessionWithView(**captured, shown, absolutePath(file).parent_path(), *references, progress, embedding);
        if (!session) return tl::unexpected(session.error());
        keepUnknown(foreign, *session);
        return writeSession(*session, file, progress);
      },
      [this, file, embedding, written, saved](const Expected<void> &result) {
        isSaving_ = false;
        if (!result) return parts_.failed("The session could not be saved", result.error());
        onSaved(file, embedding, written);
        if (saved) saved();
      });
}

void SessionController::onSaved(const std::filesystem::path &file, Embedding embedding, const Baseline &written) {
  std::string text = pathText(file);
  // Otherwise another simulation has been opened meanwhile.
  if (written.simulation == 0 || written.simulation == serial_) {
    file_ = file;
    embedding_ = embedding;
    baseline_ = written;
    if (!isModified()) recovery_.discard();
    const std::shared_ptr<ChangeLog> changes = parts_.session.changes();
    if (changes && !changes->isComplete())
      text += "\nThe simulator does not report changes made in its panels and by its tools; they are not saved.";
    for (const std::filesystem::path &changed : references_->changedSince(openedAt_))
      text += "\n" + pathText(changed) + " has changed since it was opened. The session cannot be continued with it.";
  }
  parts_.panels.notify(C3DE_LOG_INFO, "Session saved", text);
}

void SessionController::open(const std::filesystem::path &file) {
  const std::string name = pathText(file.filename());
  const auto opened = std::make_shared<WorkstationLoader::OpenedSession>();
  opened->file = file;
  (void)parts_.session.jobs().submit(
      kJobOwner, "Reading " + name,
      [opened](const ProgressFn &progress) -> Expected<void> {
        auto saved = readSession(opened->file, EmbeddedContent::stays);
        if (!saved) return tl::unexpected(saved.error());
        opened->saved = std::move(*saved);
        auto files = locateFiles(opened->saved, opened->file, progress);
        if (!files) return tl::unexpected(files.error());
        opened->files = std::move(*files);
        return {};
      },
      [this, opened, name](const Expected<void> &result) {
        if (!result) return parts_.failed("Could not open " + name, result.error());
        if (MissingFilesController::isNeeded(opened->files)) return missing_.show(opened);
        build(opened);
      });
}

void SessionController::build(const MissingFilesController::Opened &opened) {
  const std::string name = pathText(opened->file.filename());
  (void)parts_.session.jobs().submit(
      kJobOwner, "Reading " + name,
      [opened, materials = &parts_.session.materials()](const ProgressFn &) -> Expected<void> {
        auto mask = maskOfSelection(opened->saved, opened->file);
        if (!mask) return tl::unexpected(mask.error());
        opened->mask = std::move(*mask);
        if (opened->saved.scenes.empty()) return {};
        auto source = sourceOfSession(opened->saved, opened->file, opened->files, materials);
        if (!source) return tl::unexpected(source.error());
        opened->source = std::move(*source);
        return {};
      },
      [this, opened, name](const Expected<void> &result) {
        if (!result) return parts_.failed("Could not open " + name, result.error());
        parts_.session.keepInUse(opened->files);
        if (opened->source.empty()) {
          // A present simulation is not that of the session.
          if (!parts_.session.simulation()) onLoaded(opened);
          return showView(*opened);
        }
        parts_.loader.openSession(opened);
      });
}

void SessionController::begin() {
  if (recovery_.isWritten())
    if (const std::filesystem::path left = recovery_.handOver(); !left.empty() && autosaved_)
      notifyLost("Not saved: " + title_, {left, title_, {}, autosaved_->steps, 0.0});
  recovery_.discard();
  ++serial_;
  openedAt_ = std::filesystem::file_time_type::clock::now();
  references_ = std::make_shared<FileReferences>();
  file_.clear();
  embedding_ = Embedding::extracted;
  foreign_ = {};
  baseline_.reset();
  autosaved_.reset();
  refusedSince_.reset();
}

void SessionController::onLoaded(const std::shared_ptr<const WorkstationLoader::OpenedSession> &session,
                                 const std::string &notRestored) {
  if (session && !session->action.empty()) return onReplaced();
  if (session && session->saved.view.measurements) parts_.measurements.assign(setOf(*session->saved.view.measurements));
  if (session && session->saved.view.match)
    parts_.match.assign(formOf(*session->saved.view.match, session->file.parent_path()));
  begin();
  const bool isRecovered = session && session->file.parent_path() == recoveryFolder();
  if (!isRecovered) baseline_ = present();
  if (!session) return;
  if (isRecovered)
    recovered_ = session->file;
  else if (session->file != unnamed_)
    file_ = session->file;
  keepUnknown(session->saved, foreign_);
  const std::vector<ReferencedFile> &files = session->saved.files;
  if (!files.empty() && std::all_of(files.begin(), files.end(), [](const auto &one) { return one.isEmbedded; }))
    embedding_ = Embedding::all;
  if (baseline_) baseline_->steps = session->saved.steps;
  if (!notRestored.empty()) {
    baseline_.reset();
    parts_.panels.notify(C3DE_LOG_WARN, "The state was not restored",
                         "The simulation begins at its initial state, because files have changed.\n" + notRestored);
  }
  showView(*session);
}

void SessionController::onMade(bool hasReplaced) {
  if (hasReplaced) begin();
  baseline_.reset();
}

/// Camera at once, the rest when the image is shown.
void SessionController::showView(const WorkstationLoader::OpenedSession &opened) {
  const SessionView &view = opened.saved.view;
  if (view.measurements) parts_.measurements.assign(setOf(*view.measurements));
  pendingView_ = view;
  pendingMask_ = opened.mask;
  const auto placeOf = [&opened](const std::string &path) {
    for (const FoundFile &file : opened.files)
      if (file.file.path == path) return file.at;
    return pathFromText(path);
  };
  pendingComparison_ = view.comparison ? placeOf(view.comparison->image) : std::filesystem::path();
  if (view.image.empty()) return onImageShown();
  // A scene with an image has opened it, in the series that it names.
  const auto *first = opened.source.empty() ? nullptr : std::get<SharedScene>(opened.source.front()).get();
  if (first != nullptr && first->image && (view.series.empty() || view.series == first->image->series)) return;
  std::vector<std::filesystem::path> labels;
  for (const std::string &path : view.labels) labels.push_back(placeOf(path));
  parts_.images.open(placeOf(view.image), labels, view.series, static_cast<std::size_t>(view.time),
                     WorkstationImages::Segmentation::image, true);
}

void SessionController::onImageShown() {
  if (!pendingView_) return;
  const SessionView view = *std::exchange(pendingView_, std::nullopt);
  if (!view.comparison) onComparisonRestored();
  ui::ImageViews &views = parts_.images.views();
  if (views.image() != nullptr) {
    views.chooseTime(static_cast<std::size_t>(view.time));
    if (view.crossHair_mm) views.setCrossHair(*view.crossHair_mm);
    ui::ImageOptions options = views.options();
    if (view.window) options.windowLevel.window = *view.window;
    if (view.level) options.windowLevel.level = *view.level;
    views.setOptions(options);
    if (view.selection) {
      segmentation::Selection picked{
          std::exchange(pendingMask_, nullptr), {}, view.selection->name, view.selection->low, view.selection->high};
      for (const std::uint64_t label : view.selection->labels)
        if (label <= std::numeric_limits<std::uint16_t>::max())
          picked.labels.push_back(static_cast<std::uint16_t>(label));
      parts_.images.restoreSelection(std::move(picked));
    }
    if (view.comparison) parts_.comparison.restore(std::exchange(pendingComparison_, {}), *view.comparison);
  }
  if (!view.camera) return;
  render::Camera pose = parts_.window.camera();
  pose.focus = view.camera->focus_mm;
  pose.yaw = view.camera->yaw_rad;
  pose.pitch = view.camera->pitch_rad;
  pose.distance = view.camera->distance_mm;
  parts_.window.requestPose(pose);
}

void SessionController::onSelectionRestored() {
  if (baseline_) baseline_->selection = present().selection;
}

void SessionController::onComparisonRestored() {
  if (baseline_) baseline_->comparison = present().comparison;
}

void SessionController::onClosed() { begin(); }

void SessionController::onReplaced() {
  ++serial_;
  baseline_.reset();
}

void SessionController::setAutosaveInterval(double interval_s) {
  autosaveInterval_ = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(interval_s));
}

void SessionController::autosaveIfDue() {
  const Clock::time_point now = Clock::now();
  // The file that was restored stays until this run has one of its own, or the work is saved.
  if (!recovered_.empty() && (recovery_.isWritten() || (baseline_ && !isModified())))
    removeRecovery(std::exchange(recovered_, {}));
  if (now - autosaveTried_ < autosaveInterval_ || isSaving_ || recovery_.isWriting() || !isModified()) return;
  const Baseline present = this->present();
  if (autosaved_ == present && !recovery_.hasFailed()) return;
  autosaveTried_ = now;
  capture([this, present, serial = serial_, shown = shownView()](const Captured &captured) {
    if (serial != serial_) return;
    // A state that cannot be stored now is tried again at the next interval.
    if (!*captured) return onAutosaveRefused(captured->error());
    refusedSince_.reset();
    hasReportedRefusal_ = false;
    autosaved_ = present;
    autosaved_->steps = (*captured)->steps;
    if (const scene::Node *node = parts_.session.sceneGraph().find(parts_.session.simulationNode()))
      title_ = node->name;
    recovery_.write(captured, shown);
  });
}

/// The simulator refuses it for a while, for example while bodies are added; what lasts longer is reported.
void SessionController::onAutosaveRefused(const Error &error) {
  constexpr auto kReportedAfter = std::chrono::seconds(60);
  const Clock::time_point now = Clock::now();
  if (!refusedSince_) refusedSince_ = now;
  if (now - *refusedSince_ < kReportedAfter || std::exchange(hasReportedRefusal_, true)) return;
  parts_.panels.notify(C3DE_LOG_WARN, "Autosave failed",
                       error.message + "\nThe program tries again every " +
                           formatNumber(std::chrono::duration<double>(autosaveInterval_).count()) + " s.");
}

void SessionController::notifyLost(const std::string &title, const LostSession &lost) {
  parts_.panels.notify(
      C3DE_LOG_WARN, title,
      fmt::format("{}{}. It was not saved.", lost.title.empty() ? "A session" : lost.title,
                  lost.steps > 0 ? " at " + stepText(lost.steps, lost.time_s) : std::string()),
      {{"Restore", [this, lost] { open(lost.file); }}, {"Delete", [lost] { removeRecovery(lost.file); }}});
}

void SessionController::offerRecovery() {
  const auto lost = std::make_shared<std::vector<LostSession>>();
  std::error_code code;
  if (!std::filesystem::exists(recoveryFolder(), code) && !std::filesystem::exists(extractionFolder(), code)) return;
  (void)parts_.session.jobs().submit(
      kJobOwner, "Looking for unsaved work",
      [lost](const ProgressFn &) -> Expected<void> {
        *lost = SessionRecovery::lost(recoveryFolder());
        // Recovery files refer to extracted files.
        if (lost->empty()) removeUnusedExtractions();
        return {};
      },
      [this, lost](const Expected<void> &) {
        for (const LostSession &one : *lost) notifyLost("Unsaved work of " + timeText(one.savedAt), one);
      });
}

}  // namespace c3de::app
