// SPDX-License-Identifier: Apache-2.0
#include "workstation/replay_controller.h"

#include <algorithm>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/path_text.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulation_state.h"
#include "workstation/workstation_export.h"

namespace c3de::app {
namespace {

/// Parts after which the window shows the state that was reached.
constexpr std::chrono::milliseconds kSeekPart{120}, kPlayPart{50};
/// Playing that is further behind does not catch up.
constexpr double kLongestDelay_s = 0.25, kMeasured_s = 0.5;

}  // namespace

void ReplayController::connect(ui::WindowActions &actions) {
  // While a stretch is exported, nothing but its end moves the timeline.
  actions.replay.seek = [this](std::uint64_t position) {
    if (!export_) seek(position);
  };
  actions.replay.play = [this](bool plays) {
    if (!export_) play(plays);
  };
  actions.replay.step = [this] {
    if (!export_) step();
  };
  actions.replay.cancel = [this] { cancel(); };
  actions.replay.setRate = [this](double rate) { rate_ = rate; };
  actions.replay.leave = [this] { leave(); };
  actions.replay.returnToNow = [this] {
    if (hasKept() && !export_) returnTo(opened_->kept);
  };
  connectExport(actions.replay);
  actions.transport = [this, ordinary = actions.transport](std::uint32_t action) {
    isReplaying() ? transport(action) : ordinary(action);
  };
  actions.setTargetRate = [this, ordinary = actions.setTargetRate](double rate) {
    if (!isReplaying()) return ordinary(rate);
    rate_ = rate;
    owed_s_ = 0.0;
  };
  actions.reload = [this, ordinary = actions.reload] {
    if (!file_.empty() && parts_.session.simulation() && parts_.session.simulationNode() == node_) return open(file_);
    ordinary();
  };
  actions.title = [this, ordinary = actions.title] {
    return isReplaying() ? pathText(opened_->file.filename()) + " - C3DE" : ordinary();
  };
}

void ReplayController::openPast(const std::filesystem::path &file) {
  Session &session = parts_.session;
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr || isReplaying()) return open(file);
  const auto identity = presentSimulator(session);
  if (!identity) return parts_.failed("The timeline could not be shown", identity.error());
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  if (const scene::Node *node = session.sceneGraph().find(session.simulationNode())) keptTitle_ = node->name;
  simulation->post([this, simulation, &session, identity = *identity, changes = session.changes(), file] {
    Expected<CapturedState> captured;
    try {
      captured = captureState(session, simulation->object(), identity, *changes);
    } catch (const std::exception &error) {
      captured = fail(ErrorCode::internal, error.what());
    }
    const auto kept = captured ? std::make_shared<const CapturedState>(std::move(*captured)) : nullptr;
    session.mainQueue().post([this, kept, file, error = captured ? Error{} : captured.error()] {
      kept ? open(file, kept) : parts_.failed("The timeline could not be shown", error);
    });
  });
}

void ReplayController::returnTo(const std::shared_ptr<const CapturedState> &kept) {
  cancel();
  const auto session = std::make_shared<WorkstationLoader::OpenedSession>();
  session->file = file_;
  session->action = "return to the present";
  session->title = keptTitle_;
  session->saved.simulatorClass = kept->identity.classId;
  session->saved.state = kept->state;
  session->saved.stateHash = kept->hash;
  session->saved.steps = kept->steps;
  session->saved.time_s = kept->time_s;
  session->source = kept->source;
  returning_ = session;
  parts_.loader.openSession(session, true, [this](const Expected<void> &result) {
    if (!result) parts_.failed("The simulation could not be returned to", result.error());
  });
}

void ReplayController::open(const std::filesystem::path &file, std::shared_ptr<const CapturedState> kept) {
  const std::string name = pathText(file.filename());
  const auto opened = std::make_shared<Opened>();
  opened->file = file;
  opened->kept = std::move(kept);
  (void)parts_.session.jobs().submit(
      kJobOwner, "Reading " + name,
      [opened, materials = &parts_.session.materials()](const ProgressFn &progress) -> Expected<void> {
        auto recording = readRecording(opened->file);
        if (!recording) return tl::unexpected(recording.error());
        const SessionFile &saved = recording->start.session;
        if (saved.scenes.empty()) return fail(ErrorCode::input, pathText(opened->file) + ": " + kNothingToReplay);
        auto files = filesOfSession(saved, opened->file, progress);
        if (!files) return tl::unexpected(files.error());
        opened->files = std::move(*files);
        auto source = sourceOfSession(saved, opened->file, opened->files, materials);
        if (!source) return tl::unexpected(source.error());
        if (source->empty()) return fail(ErrorCode::input, pathText(opened->file) + ": is a recording without a scene");
        opened->timeline = std::make_shared<Timeline>(std::move(*recording), opened->file, std::move(*source));
        return {};
      },
      [this, opened](const Expected<void> &result) { onRead(opened, result); });
}

void ReplayController::onRead(const std::shared_ptr<Opened> &opened, Expected<void> result) {
  if (result) {
    const Timeline &timeline = *opened->timeline;
    const auto &scene = *std::get<SharedScene>(timeline.jumpToStart().from->source->front());
    const auto identity = parts_.session.chooseSimulator(scene.simulatorClass);
    result = identity ? timeline.replay().checkSimulator(*identity) : Expected<void>(tl::unexpected(identity.error()));
  }
  if (!result) return parts_.failed("Could not open " + pathText(opened->file.filename()), result.error());
  parts_.session.keepInUse(opened->files);
  auto marks = std::make_shared<std::vector<ui::ReplayView::Mark>>();
  for (const TimelineMark &mark : opened->timeline->axis().marks()) marks->push_back({mark.made, mark.text});
  opened->marks = std::move(marks);
  build(opened, opened->timeline->jumpToStart());
}

/// Builds another simulator from a keyframe.
void ReplayController::build(std::shared_ptr<Opened> opened, const Timeline::Jump &jump) {
  const auto session = std::make_shared<WorkstationLoader::OpenedSession>();
  session->file = opened->file;
  session->files = opened->files;
  session->saved = opened->timeline->recording().start.session;
  session->source = *jump.from->source;
  if (session->saved.state != jump.from->state) {
    session->saved.state = jump.from->state;
    session->saved.stateHash.reset();
  }
  pending_ = session;
  pendingFrom_ = jump.from;
  isOpening_ = std::move(opened);
  parts_.loader.openSession(session, isOpening_ == opened_,
                            [this, serial = ++builds_](const Expected<void> &result) { onBuilt(result, serial); });
}

void ReplayController::onBuilt(const Expected<void> &result, std::uint64_t serial) {
  if (result || serial != builds_) return;
  const std::string name = isOpening_ ? pathText(isOpening_->file.filename()) : std::string();
  pending_.reset();
  export_.reset();
  isOpening_.reset();
  target_.reset();
  isPlaying_ = false;
  parts_.failed("Could not open " + name, result.error());
}

ReplayController::Present ReplayController::onLoaded(
    const std::shared_ptr<const WorkstationLoader::OpenedSession> &session) {
  const bool isKept = session && session == returning_;
  if (isKept && opened_) opened_->kept.reset();
  if (!session || session != pending_) {
    end();
    if (isKept) node_ = {};
    return isKept ? Present::keptOne : Present::other;
  }
  if (isOpening_ != opened_) {
    end();
    opened_ = isOpening_;
    rate_ = 1.0;
    warning_ = opened_->timeline->recording().whyIncomplete();
    if (!warning_.empty()) warning_ = "The recording " + warning_;
    stretch_ = {0, opened_->timeline->axis().length()};
  }
  isOpening_.reset();
  pending_.reset();
  ++serial_;
  isBusy_ = false;
  file_ = opened_->file;
  node_ = parts_.session.simulationNode();
  // What a tool did to the previous simulation is no part of this one.
  (void)parts_.tools.activate({});
  opened_->timeline->rebuilt(std::exchange(pendingFrom_, nullptr));
  position_ = opened_->timeline->position();
  beginStretch();
  seek(target_.value_or(position_));
  return Present::replay;
}

void ReplayController::end() {
  if (hasKept())
    parts_.panels.notify(C3DE_LOG_INFO, "The timeline was closed", "The simulation from before it is still there.",
                         {{"Return to now", [this, kept = opened_->kept] { returnTo(kept); }}});
  if (export_)
    parts_.panels.notify(C3DE_LOG_WARN, "The export ended", "The replay was closed. What was written is kept.");
  ++serial_;
  stop_->store(true);
  export_.reset();
  opened_.reset();
  target_.reset();
  isBusy_ = isPlaying_ = false;
  position_ = 0;
  warning_.clear();
}

void ReplayController::transport(std::uint32_t action) {
  if (export_) return;
  switch (action) {
    case C3DE_TRANSPORT_PLAY: return play(true);
    case C3DE_TRANSPORT_PAUSE: return isPlaying_ ? play(false) : cancel();
    case C3DE_TRANSPORT_STEP: return step();
    case C3DE_TRANSPORT_STOP:
    case C3DE_TRANSPORT_RESET: play(false); return seek(0);
    default: return;
  }
}

void ReplayController::play(bool plays) {
  if (!isReplaying()) return;
  isPlaying_ = plays && position_ < opened_->timeline->axis().length();
  tick_ = measuredAt_ = Clock::now();
  owed_s_ = measured_s_ = factor_ = 0.0;
  if (!plays && isBusy_ && !target_) stop_->store(true);
}

void ReplayController::seek(std::uint64_t position) {
  if (!isReplaying()) return;
  target_ = std::min(position, opened_->timeline->axis().length());
  if (isBusy_)
    stop_->store(true);
  else if (!pending_)
    continueSeek();
}

void ReplayController::step() {
  if (!isReplaying() || target_) return;
  play(false);
  seek(position_ + 1);
}

void ReplayController::cancel() {
  if (export_) {
    export_->isCancelled = true;
    stop_->store(true);
    if (pending_) parts_.loader.cancel();
    if (!isBusy_ && !pending_) finishExport({});
    return;
  }
  target_.reset();
  isPlaying_ = false;
  if (isBusy_) stop_->store(true);
  if (pending_) parts_.loader.cancel();
}

void ReplayController::continueSeek() {
  const Timeline::Jump jump = opened_->timeline->jumpTo(*target_);
  if (jump.kind == Timeline::JumpKind::rebuild) return build(opened_, jump);
  Timeline::Limits limits;
  limits.until = *target_;
  limits.mayTry = true;
  limits.deadline = Clock::now() + kSeekPart;
  post(jump, std::move(limits));
}

void ReplayController::continuePlaying() {
  const Clock::time_point now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - std::exchange(tick_, now)).count();
  Timeline::Limits limits;
  limits.until = opened_->timeline->axis().length();
  limits.deadline = now + kPlayPart;
  if (rate_ > 0.0) {
    owed_s_ = std::min(owed_s_ + rate_ * passed_s, rate_ * kLongestDelay_s);
    if (owed_s_ <= 0.0) return;
    limits.simulated_s = owed_s_;
  }
  post({}, std::move(limits));
}

void ReplayController::post(const Timeline::Jump &jump, Timeline::Limits limits) {
  scene::Simulation *simulation = parts_.session.simulation();
  isBusy_ = true;
  stop_ = std::make_shared<std::atomic<bool>>(false);
  limits.isStopped = [stop = stop_] { return stop->load(); };
  simulation->post([this, jump, limits = std::move(limits), timeline = opened_->timeline, serial = serial_,
                    target = Timeline::Target{parts_.session, *simulation, parts_.session.changes()}] {
    Expected<Timeline::Advanced> advanced = Timeline::Advanced{Timeline::Outcome::retry, 0.0};
    try {
      if (jump.kind == Timeline::JumpKind::forward || timeline->restore(target, jump.from))
        advanced = timeline->advance(target, limits);
    } catch (const std::exception &error) {
      advanced = fail(ErrorCode::internal, error.what());
    }
    target.session.mainQueue().post([this, serial, advanced] {
      if (serial == serial_) onAdvanced(advanced);
    });
  });
}

void ReplayController::onAdvanced(const Expected<Timeline::Advanced> &advanced) {
  const Timeline &timeline = *opened_->timeline;
  isBusy_ = false;
  const std::uint64_t before = std::exchange(position_, timeline.position());
  if (!timeline.difference().empty()) warning_ = "The replay " + timeline.difference();
  if (export_ && (!advanced || export_->isCancelled))
    return finishExport(advanced ? Expected<void>() : tl::unexpected(advanced.error()));
  if (!advanced) {
    target_.reset();
    isPlaying_ = false;
    warning_ = "The replay ends here: " + advanced.error().message;
    return parts_.failed("The replay ended", advanced.error());
  }
  if (advanced->outcome == Timeline::Outcome::retry) {
    // The state is that of no position, so the jump continues also after Cancel.
    if (!target_) target_ = std::max(before, position_);
  } else if (target_ && *target_ == position_) {
    target_.reset();
    tick_ = Clock::now();
    if (export_) return continueExport();
  } else if (!target_) {
    owed_s_ -= advanced->simulated_s;
    measureRate(advanced->simulated_s);
    if (timeline.isAtEnd()) isPlaying_ = false;
  }
  if (target_) continueSeek();
}

void ReplayController::measureRate(double simulated_s) {
  measured_s_ += simulated_s;
  const Clock::time_point now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - measuredAt_).count();
  if (passed_s < kMeasured_s) return;
  factor_ = measured_s_ / passed_s;
  measured_s_ = 0.0;
  measuredAt_ = now;
}

void ReplayController::leave() {
  if (!isReplaying() || isBusy_ || target_ || pending_ || export_) return;
  scene::Simulation *simulation = parts_.session.simulation();
  end();
  parts_.left();
  parts_.panels.notify(C3DE_LOG_INFO, "The replay ended", "The simulation continues from here. It is not saved.");
  // Paused rather than stopped; no step is made between the two.
  simulation->post([simulation] {
    simulation->transport(C3DE_TRANSPORT_PLAY);
    simulation->transport(C3DE_TRANSPORT_PAUSE);
  });
}

void ReplayController::show(ui::SimulationView &view) {
  if (!isReplaying()) return;
  if (isPlaying_ && !export_ && !isBusy_ && !target_ && !pending_) continuePlaying();
  auto replay = std::make_shared<ui::ReplayView>();
  replay->file = pathText(opened_->file.filename());
  replay->marks = opened_->marks;
  replay->timeAt_s = [timeline = opened_->timeline](std::uint64_t at) { return timeline->axis().timeAt_s(at); };
  replay->position = position_;
  replay->length = opened_->timeline->axis().length();
  replay->target = target_.value_or(position_);
  replay->isPlaying = isPlaying_;
  replay->isSeeking = target_.has_value();
  replay->rate = rate_;
  replay->hasNow = hasKept();
  replay->warning = warning_;
  showExport(*replay);
  view.transport.mode = isPlaying_ || target_ || export_ ? C3DE_SIM_PLAYING : C3DE_SIM_PAUSED;
  view.transport.target_rate = rate_;
  view.transport.real_time_factor = factor_;
  view.replay = std::move(replay);
}

}  // namespace c3de::app
