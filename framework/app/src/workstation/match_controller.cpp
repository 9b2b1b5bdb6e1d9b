// SPDX-License-Identifier: Apache-2.0
#include "workstation/match_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/simulator_access.h"
#include "workstation/match_texts.h"

namespace c3de::app {
namespace {

constexpr const char *kFailed = "The body was not matched";
/// Parts of the progress at the end of reading and of the rigid motion.
constexpr double kRead = 0.05, kMoved = 0.5;

/// A stage of a job that ends at a part of its progress.
ProgressFn stageOf(const ProgressFn &progress, double begin, double end) {
  return [&progress, begin, end](double fraction, const std::string &what) {
    return progress(fraction < 0.0 ? fraction : begin + (end - begin) * std::min(fraction, 1.0), what);
  };
}

bool isDeformed(const BodySkins &skins, double tolerance_mm) {
  for (std::size_t i = 0; i < skins.rest.vertices.size(); ++i)
    if (norm(skins.present.vertices[i] - skins.rest.vertices[i]) > tolerance_mm) return true;
  return false;
}

std::string joined(const std::vector<std::string> &extensions) {
  std::string text;
  for (const std::string &extension : extensions) text += (text.empty() ? "" : ";") + extension.substr(1);
  return text;
}

}  // namespace

/// A match, from its beginning to its result.
struct MatchController::Attempt {
  scene::SceneMatch wanted;         ///< with the name of the body in the simulator
  std::shared_ptr<ChangeLog> log;   ///< of its simulation
  SharedScene scene;                ///< from which that was built; null: none
  std::vector<Landmark> landmarks;  ///< with targets
  BodySkins skins;
  MatchTargets targets;
  std::optional<RigidMatch> rigid;
  std::optional<std::size_t> chosen;  ///< candidate from which the user has the body deformed
  ElasticMatch elastic;
  std::uint64_t capture = 0;                        ///< of the state before it; 0: none
  bool isStreamed = false;                          ///< `targets` are a frame of a stream
  bool isStopped = false;                           ///< its stream has ended
  std::optional<Mat4> motionBefore;                 ///< of the frame before, from which it starts
  std::vector<Landmark> allLandmarks;               ///< of a streamed match: those without targets as well
  std::vector<session::MeasuredLandmark> expected;  ///< of these, those of the body, after the match
  double wall_s = 0.0;                              ///< of a streamed match
  Expected<void> read;                              ///< from the simulation
  bool isMatched = false;                           ///< the job has ended, and the body has its new shape
  /// Progress of the job, for the main thread.
  struct Progress {
    std::atomic<bool> hasMotion = false;   ///< `targets` and `rigid` are complete
    std::atomic<unsigned> iterations = 0;  ///< of the deformation
  };
  std::shared_ptr<Progress> progress;

  [[nodiscard]] const Mat4 &motion() const {
    return elastic.body ? elastic.body->measuredFromBody : rigid->rigid.measuredFromBody;
  }
  [[nodiscard]] scene::SceneFile sceneOrNone() const { return scene ? *scene : scene::SceneFile(); }

  /// [sim]
  [[nodiscard]] Expected<void> readBefore(Session &session, c3de_object *simulator) {
    const auto takeError = [&session] { return session.plugins().takeError(); };
    const ChangeLog::Unrecorded reads(*log);
    auto found = skinsOf(simulator, wanted.body, takeError);
    if (!found) return tl::unexpected(found.error());
    skins = std::move(*found);
    scene::SceneMatch reading = wanted;
    if (isStreamed) reading.fitsLandmarks = false;  // a frame may have none
    auto own = landmarksOfBody(simulator, sceneOrNone(), landmarks, reading, wanted.body, takeError);
    if (!own) return tl::unexpected(own.error());
    landmarks = std::move(*own);
    if (isStreamed && landmarks.empty()) wanted.fitsLandmarks = false;
    return {};
  }
  /// [sim]
  [[nodiscard]] Expected<void> readExpected(c3de_object *simulator, const std::function<std::string()> &takeError) {
    if (auto good = findBodies(simulator, sceneOrNone(), allLandmarks, takeError); !good) return good;
    std::erase_if(allLandmarks, [this](const Landmark &one) { return !one.body.empty() && one.body != wanted.body; });
    auto measured = measure(simulator, {}, allLandmarks, takeError);
    if (!measured) return tl::unexpected(measured.error());
    expected = std::move(measured->landmarks);
    return {};
  }
  /// [sim]
  [[nodiscard]] Expected<void> readAfter(Session &session, c3de_object *simulator) {
    const auto takeError = [&session] { return session.plugins().takeError(); };
    const ChangeLog::Unrecorded reads(*log);
    auto found = skinsOf(simulator, wanted.body, takeError);
    if (!found) return tl::unexpected(found.error());
    if (found->present.vertices.size() != skins.rest.vertices.size())
      return fail(ErrorCode::state, "the body has another surface than at the beginning");
    skins.present = std::move(found->present);
    if (isStreamed)
      if (auto good = readExpected(simulator, takeError); !good) return good;
    return measureLandmarks(simulator, landmarks, *rigid, takeError, elastic);
  }
  [[nodiscard]] Expected<void> matchFrameOfStream(Session &session, c3de_object *simulator, const char *owner,
                                                  const ProgressFn &report) {
    auto frame = matchPoints(
        simulator, wanted.body, skins.rest, targets, landmarks, wanted, motionBefore, owner,
        [&session] { return session.plugins().takeError(); }, &session.pool(), report);
    if (!frame) return tl::unexpected(frame.error());
    rigid = std::move(frame->rigid);
    elastic = std::move(frame->elastic);
    wall_s = frame->wall_s;
    return {};
  }
  /// In a background job.
  [[nodiscard]] Expected<void> match(Session &session, c3de_object *simulator, const char *owner,
                                     const ProgressFn &report) {
    if (isStreamed) return matchFrameOfStream(session, simulator, owner, report);
    Expected<RigidMatch> found;
    if (chosen) {
      found = withCandidate(*rigid, *chosen, skins.rest, targets, &session.pool());
    } else {
      BodySources sources;
      auto measured = readMatchTargets(wanted, session.meshFormats(), sources, stageOf(report, 0.0, kRead));
      if (!measured) return tl::unexpected(measured.error());
      targets = std::move(*measured);
      found = findMotion(skins.rest, targets, landmarks, wanted, &session.pool(), stageOf(report, kRead, kMoved));
    }
    if (!found) return tl::unexpected(found.error());
    rigid = std::move(*found);
    progress->hasMotion = true;
    if (!wanted.deforms || !(rigid->isUsable() || chosen)) return {};
    const ProgressFn counted = [this, deformed = stageOf(report, kMoved, 1.0)](double fraction,
                                                                               const std::string &what) {
      ++progress->iterations;
      return deformed(fraction, what);
    };
    auto deformed =
        deformBody(simulator, wanted.body, *rigid, targets, landmarks, wanted, owner,
                   [&session] { return session.plugins().takeError(); }, counted, {.showsIterations = true});
    if (!deformed) return tl::unexpected(deformed.error());
    elastic = std::move(*deformed);
    return {};
  }
};

MatchController::MatchController(Parts parts)
    : parts_(std::move(parts)), presenter_(parts_.renderer, parts_.session.sceneGraph()) {}

MatchController::~MatchController() = default;

void MatchController::connect(ui::WindowActions &actions) {
  actions.matchBody = [this] { open(); };
  actions.exportResiduals = [this](const std::filesystem::path &file) { exportResiduals(file); };
  actions.whyNoResiduals = [this] { return result_ ? std::string() : std::string("No body was matched."); };
}

SharedScene MatchController::presentScene() const {
  const std::shared_ptr<ChangeLog> changes = parts_.session.changes();
  const SimulationSource source = changes ? changes->source() : SimulationSource();
  const auto *first = source.empty() ? nullptr : std::get_if<SharedScene>(&source.front());
  return first ? *first : nullptr;
}

void MatchController::fillForm() {
  if (parts_.values.areSet()) return;
  ui::MatchForm form;
  if (const SharedScene scene = presentScene(); scene && scene->match) {
    form = ui::matchFormOf(*scene->match);
    form.wanted.body = nameInSimulator(*scene, form.wanted.body);
  }
  parts_.values.assign(std::move(form));
}

void MatchController::open() {
  if ((attempt_ || stream_) && panel_) return;
  fillForm();
  shownAssignments_ = parts_.values.assignments();
  readBodies();
  // Anew, so that the window scrolls to it.
  panel_.reset();
  ui::MatchPanel::Actions actions;
  actions.view = [this] { return view(); };
  actions.begin = [this] { begin(); };
  actions.cancel = [this] { cancel(); };
  actions.show = [this](std::size_t candidate) { show(candidate); };
  actions.deform = [this](std::size_t candidate) { beginFrom(candidate); };
  actions.close = [this] { parts_.session.mainQueue().post(unlessDestroyed([this] { close(); })); };
  panel_.emplace(parts_.panels, parts_.values.form, std::move(actions));
}

void MatchController::close() {
  endStream({});
  panel_.reset();
  forgetResult();
}

void MatchController::forgetResult() {
  presenter_.forget();
  result_.reset();
  texts_ = {};
}

void MatchController::onReplaced() {
  if (!job_.isNull()) parts_.session.jobs().cancel(std::exchange(job_, {}));
  attempt_.reset();
  if (stream_)
    parts_.panels.notify(C3DE_LOG_INFO, "The stream of the tracking system has ended",
                         "Another simulation is the present one.", {}, registry::About::simulation);
  stream_.reset();
  forgetResult();
  bodies_.clear();
  shownLog_.reset();
}

void MatchController::update() {
  presenter_.followTree();
  showIterations();
  followStream();
  if (!panel_) return;
  if (parts_.values.assignments() != shownAssignments_) open();
  parts_.values.countChanges();
  presenter_.setArrowScale(panel_->arrowScale());
  const std::shared_ptr<ChangeLog> log = parts_.session.changes();
  if (log != shownLog_ || (log && log->count() != shownChanges_)) readBodies();
}

void MatchController::showIterations() {
  if (!attempt_ || !attempt_->progress->hasMotion || attempt_->isMatched) return;
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation || parts_.session.changes() != attempt_->log) return;
  if (!std::exchange(showsMotion_, true))
    showPoints(*attempt_, attempt_->skins.rest, {}, attempt_->rigid->rigid.measuredFromBody);
  if (const unsigned now = attempt_->progress->iterations; now != std::exchange(shownIterations_, now))
    simulation->post([] {});  // any command publishes a snapshot
}

void MatchController::readBodies() {
  shownLog_ = parts_.session.changes();
  shownChanges_ = shownLog_ ? shownLog_->count() : 0;
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation) return bodies_.clear();
  simulation->post(
      [&session = parts_.session, log = shownLog_, object = simulation->object(),
       set = unlessDestroyed([this](const std::shared_ptr<ChangeLog> &of, std::vector<std::string> names) {
         if (of == shownLog_) bodies_ = std::move(names);
       })] { session.mainQueue().post([set, log, names = simulatedBodies(object)] { set(log, names); }); });
}

ui::MatchView MatchController::view() {
  ui::MatchView out;
  out.bodies = bodies_;
  out.meshExtensions = joined(parts_.session.meshFormats().extensions());
  const segmentation::ScanBody::Sources &open = parts_.images.scanBody().sources();
  out.openLabels = open.labelFile;
  for (const auto &layer : open.layers)
    for (const imaging::LabelMap::Label &label : layer->map.labels) out.labelNames.push_back(label.name);
  if (!parts_.session.simulation()) out.whyNot = "No simulation is open.";
  if (attempt_) out.progress = {-1.0, "Reading the body"};
  for (const BackgroundJobs::Status &job : parts_.session.jobs().running())
    if (attempt_ && job.handle == job_) {
      out.progress = {job.fraction, job.cancelling ? "Cancelling" : job.what};
      out.isCancelling = job.cancelling;
    }
  if (stream_) out.stream = stream_->status();
  if (result_) out.result = &texts_;
  return out;
}

Expected<std::vector<Landmark>> MatchController::landmarks(const std::filesystem::path &targets) const {
  scene::SceneFile named;
  named.title = "Measurements";
  for (const ui::MeasuredPoint &one : parts_.measurements.set().points) {
    scene::SceneLandmark landmark;
    landmark.name = one.name;
    landmark.body = one.body;
    landmark.at_m = (1.0 / scene::kMillimetresPerMetre) * one.reference_mm;
    if (one.target_mm) landmark.target_m = (1.0 / scene::kMillimetresPerMetre) * *one.target_mm;
    named.landmarks.push_back(std::move(landmark));
  }
  std::vector<std::filesystem::path> files;
  if (!targets.empty()) files.push_back(targets);
  return landmarksOf(named, {}, files);
}

void MatchController::beginStream() {
  const auto address = tracking::parseTrackingAddress(parts_.values.form.server);
  if (!address) return parts_.failed(kFailed, address.error());
  if (const std::string reason = parts_.blockingReason(); !reason.empty())
    return parts_.failed(kFailed, {ErrorCode::state, reason});
  const ui::MatchForm &form = parts_.values.form;
  std::optional<tracking::TrackedTool> tool;
  if (!form.tool.empty()) tool = {form.tool, form.toolPoints};
  auto link = tracking::TrackingLink::open(
      *address, tool, [&queue = parts_.session.mainQueue()] { queue.post([] {}); });  // the window draws a frame
  if (!link) return parts_.failed(kFailed, link.error());
  forgetResult();
  stream_.emplace(std::move(*link));
}

void MatchController::followStream() {
  if (!stream_) return;
  if (const auto change = stream_->takeChange())
    parts_.panels.notify(change->isBad ? C3DE_LOG_WARN : C3DE_LOG_INFO, "Tracking system " + stream_->address(),
                         displayText(change->text) + ".", {}, registry::About::simulation);
  if (attempt_) return;
  auto all = landmarks({});
  if (!all) return endStream(all.error().message);
  auto frame = stream_->take(*all);
  if (!frame) return;
  const auto attempt = std::make_shared<Attempt>();
  attempt->isStreamed = true;
  attempt->wanted = parts_.values.form.match();
  attempt->landmarks = std::move(frame->landmarks);
  attempt->allLandmarks = std::move(*all);
  attempt->targets.surface.points_mm = std::move(frame->points_mm);
  attempt->targets.file = pathFromText(stream_->address());
  attempt->motionBefore = stream_->motion();
  start(attempt);
}

void MatchController::endStream(const std::string &why) {
  if (!stream_) return;
  if (!why.empty()) parts_.failed("The stream of the tracking system has ended", {ErrorCode::state, why});
  stream_.reset();
  if (!attempt_) return;
  attempt_->isStopped = true;
  if (attempt_->isMatched) return;
  if (job_.isNull())
    attempt_.reset();  // what is being read or stored for it is not used
  else
    parts_.session.jobs().cancel(job_);
}

void MatchController::begin() {
  if (parts_.values.form.source == ui::MatchSource::stream) return beginStream();
  const auto attempt = std::make_shared<Attempt>();
  attempt->wanted = parts_.values.form.match();
  if (parts_.values.form.source == ui::MatchSource::labels)
    if (const auto good = setMatchLabel(parts_.values.form.label, attempt->wanted); !good)
      return parts_.failed(kFailed, good.error());
  const auto all = landmarks(attempt->wanted.landmarks);
  if (!all) return parts_.failed(kFailed, all.error());
  attempt->landmarks = withTargets(*all);
  if (attempt->wanted.fitsLandmarks && attempt->landmarks.empty())
    return parts_.failed(kFailed, {ErrorCode::usage,
                                   "no landmark has a measured position that could be fitted; accepted: target "
                                   "landmarks with the names of landmarks in Measurements"});
  start(attempt);
}

void MatchController::beginFrom(std::size_t candidate) {
  if (!result_) return;
  const auto attempt = std::make_shared<Attempt>(*result_);
  attempt->chosen = candidate;
  attempt->wanted.deforms = true;
  attempt->elastic = {};
  attempt->isMatched = false;
  start(attempt);
}

void MatchController::start(const SharedAttempt &attempt) {
  if (attempt_) return;
  scene::Simulation *simulation = parts_.session.simulation();
  const std::string reason = simulation ? parts_.blockingReason() : std::string("there is no simulation");
  if (!reason.empty() && attempt->isStreamed) return endStream(reason);
  if (!reason.empty()) return parts_.failed(kFailed, {ErrorCode::state, reason});
  attempt_ = attempt;
  attempt->progress = std::make_shared<Attempt::Progress>();
  showsMotion_ = false;
  shownIterations_ = 0;
  attempt->log = parts_.session.changes();
  attempt->scene = presentScene();
  if (simulation->state().mode == C3DE_SIM_PLAYING) simulation->transport(C3DE_TRANSPORT_PAUSE);
  simulation->post([attempt, &session = parts_.session, object = simulation->object(),
                    next = unlessDestroyed([this](const SharedAttempt &one) { onRead(one); })] {
    attempt->read = attempt->readBefore(session, object);
    session.mainQueue().post([attempt, next] { next(attempt); });
  });
}

void MatchController::onRead(const SharedAttempt &attempt) {
  if (attempt != attempt_) return;
  if (!attempt->read) return end(attempt, attempt->read.error());
  // All frames of a stream are one step of undo.
  if (attempt->isStreamed && stream_->canUndo) return submit(attempt);
  parts_.history.captureBefore(unlessDestroyed([this, attempt](std::uint64_t capture) {
    attempt->capture = capture;
    submit(attempt);
  }));
}

void MatchController::submit(const SharedAttempt &attempt) {
  if (attempt != attempt_) return;
  Session &session = parts_.session;
  const scene::Simulation *simulation = session.simulation();
  if (!simulation || session.changes() != attempt->log)
    return end(attempt, {ErrorCode::state, "the simulation was closed"});
  c3de_object *object = simulation->object();
  object->vt->retain(object);
  const auto simulator = std::make_shared<ObjectRef>(object);
  job_ = session.jobs().submit(
      kJobOwner, "Matching " + attempt->wanted.body,
      [attempt, simulator, &session, owner = session.plugins().ownerOf(object)](const ProgressFn &progress) {
        return attempt->match(session, simulator->get(), owner, progress);
      },
      unlessDestroyed([this, attempt](const Expected<void> &result) { onMatched(attempt, result); }));
}

void MatchController::onMatched(const SharedAttempt &attempt, const Expected<void> &result) {
  if (attempt != attempt_) return;
  job_ = {};
  if (!result) return end(attempt, result.error());
  attempt->isMatched = true;
  const std::string label = "match " + attempt->wanted.body;
  const bool hasStep = attempt->isStreamed && attempt->capture == 0;
  const bool isAdded = attempt->elastic.body && !hasStep && parts_.history.addCaptured(attempt->capture, label);
  if (attempt->isStreamed && !attempt->isStopped && attempt->elastic.body) stream_->canUndo = true;
  if (attempt->elastic.body && !hasStep && !isAdded)
    parts_.panels.notify(C3DE_LOG_WARN, "This cannot be undone: " + label,
                         "Another change was made while the body was matched.", {}, registry::About::simulation);
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation) return end(attempt, {ErrorCode::state, "the simulation was closed"});
  simulation->post([attempt, &session = parts_.session, object = simulation->object(),
                    next = unlessDestroyed([this](const SharedAttempt &one) { onMeasured(one); })] {
    attempt->read = attempt->readAfter(session, object);
    session.mainQueue().post([attempt, next] { next(attempt); });
  });
}

void MatchController::onMeasured(const SharedAttempt &attempt) {
  if (attempt != attempt_) return;
  attempt_.reset();
  if (attempt->isStopped && !panel_) return;
  result_ = attempt;
  const RigidMatch &rigid = *attempt->rigid;
  texts_ = textsOf(attempt->targets, rigid, attempt->elastic, attempt->chosen);
  if (!attempt->read)
    texts_.warnings.push_back("the body was not measured after the match: " + attempt->read.error().message);
  if (!attempt->elastic.body && isDeformed(attempt->skins, attempt->wanted.noise_mm))
    texts_.warnings.push_back("the body is deformed at present, and the points are placed at its shape at rest");
  show(texts_.shownCandidate);
  if (attempt->isStreamed) return onFrameMatched(*attempt);
  const bool isGood = rigid.isUsable() && texts_.warnings.empty();
  std::string text;
  for (const ui::MatchTexts::Row &row : texts_.sections[1].rows) text += row.name + ": " + row.value + "\n";
  if (!rigid.isUsable()) text += displayText(failureOf(rigid)) + ".\n";
  parts_.panels.notify(
      isGood ? C3DE_LOG_INFO : C3DE_LOG_WARN, "Match of " + attempt->wanted.body + ": " + verdictOf(rigid),
      text + "The panel Match shows all values. Not for clinical use.", {}, registry::About::simulation);
  log(LogLevel::info, "match of " + attempt->wanted.body + ": " + verdictOf(rigid) + "; " + text);
}

void MatchController::onFrameMatched(const Attempt &attempt) {
  if (attempt.isStopped) return;
  if (!attempt.read) return endStream(attempt.read.error().message);
  if (!attempt.rigid->isUsable()) return stream_->onFailed(failureOf(*attempt.rigid));
  session::FrameMatch match;
  match.rigid = *attempt.rigid;
  match.elastic = attempt.elastic;
  match.wall_s = attempt.wall_s;
  stream_->onMatched(match, attempt.expected);
}

void MatchController::end(const SharedAttempt &attempt, const Error &error) {
  attempt_.reset();
  job_ = {};
  if (attempt->isStopped) return;
  if (attempt->isStreamed && error.code == ErrorCode::input) return stream_->onFailed(error.message);
  if (attempt->isStreamed) stream_.reset();
  if (showsMotion_) {
    if (result_)
      show(texts_.shownCandidate);
    else
      presenter_.forget();
  }
  // The last snapshot may have the shape of an iteration.
  if (scene::Simulation *simulation = parts_.session.simulation()) simulation->post([] {});
  if (error.code == ErrorCode::cancelled)
    parts_.panels.notify(C3DE_LOG_INFO, "Match cancelled: " + attempt->wanted.body, "The body stays as it was.", {},
                         registry::About::simulation);
  else
    parts_.failed(kFailed, error);
}

void MatchController::cancel() {
  if (stream_) return endStream({});
  // Afterwards the body has its new shape, which Undo takes back.
  if (!attempt_ || attempt_->isMatched) return;
  if (job_.isNull()) return end(SharedAttempt(attempt_), {ErrorCode::cancelled, "cancelled"});
  parts_.session.jobs().cancel(job_);
}

/// The body has its present shape at the motion of a deformation, and its shape at rest at every other motion.
void MatchController::show(std::size_t candidate) {
  const Attempt &of = *result_;
  const auto &candidates = of.rigid->rigid.candidates;
  const bool isResult = candidate == of.chosen.value_or(0) || candidate >= candidates.size();
  const ElasticMatch elastic = isResult ? of.elastic : ElasticMatch();
  const Mat4 motion = isResult ? of.motion() : candidates[candidate].measuredFromBody;
  texts_.shownCandidate = candidate;
  showPoints(of, elastic.body ? of.skins.present : of.skins.rest, elastic, motion);
  if (elastic.body) presenter_.addErrors({of.skins.present, elastic.body->skinErrors_mm});
}

void MatchController::showPoints(const Attempt &of, const geometry::TriangleMesh &skin, const ElasticMatch &elastic,
                                 const Mat4 &motion) {
  auto points = matchedPoints(skin, of.targets, *of.rigid, elastic, motion);
  if (!points) return parts_.failed("The measured points are not shown", points.error());
  const Mat4 bodyFromMeasured = geometry::rigidInverse(motion);
  std::vector<ShownLandmark> landmarks;
  for (std::size_t i = 0; i < of.rigid->landmarks.size(); ++i) {
    const MatchedLandmark &one = of.rigid->landmarks[i];
    const bool isMoved = i < elastic.landmarks_mm.size();
    landmarks.push_back({isMoved ? transformPoint(bodyFromMeasured, elastic.landmarks_mm[i]) : one.reference_mm,
                         transformPoint(bodyFromMeasured, one.target_mm)});
  }
  presenter_.show(std::move(*points), landmarks, of.wanted.noise_mm, parts_.session.simulationNode());
}

void MatchController::exportResiduals(const std::filesystem::path &file) {
  if (!result_) return;
  const auto written = writeWholeFile(file, residualTable(result_->targets, *result_->rigid, result_->elastic));
  if (!written) return parts_.failed("The export could not be written", written.error());
  parts_.panels.notify(C3DE_LOG_INFO, "Exported", pathText(file));
}

}  // namespace c3de::app
