// SPDX-License-Identifier: Apache-2.0
#include "simulation.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/recorder.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulation_step.h"
#include "running.h"
#include "use.h"

namespace c3de::embed {
namespace {

using Clock = std::chrono::steady_clock;
using session::SharedScene;

constexpr double kTimeTolerance = 1e-6;  // of a step: the sum of many steps may be slightly below the end

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

static_assert(C3DE_EMBED_NUMBER == C3DE_PARAM_F64 && C3DE_EMBED_INTEGER == C3DE_PARAM_I64 &&
              C3DE_EMBED_BOOL == C3DE_PARAM_BOOL && C3DE_EMBED_CHOICE == C3DE_PARAM_CHOICE &&
              C3DE_EMBED_TEXT == C3DE_PARAM_TEXT && C3DE_EMBED_VECTOR == C3DE_PARAM_VEC3);

/// The first scene with the assignments of the caller.
Expected<SharedScene> sceneToBuild(const session::SimulationSource &source, const std::vector<std::string> &assignments,
                                   const scene::MaterialLibrary &materials) {
  auto scene = std::make_shared<scene::SceneFile>(*std::get<SharedScene>(source.front()));
  for (const std::string &one : assignments)
    if (auto applied = session::applyAssignment(*scene, one, materials); !applied)
      return tl::unexpected(applied.error());
  return scene;
}

}  // namespace

Result<std::shared_ptr<EmbeddedSimulation>> EmbeddedSimulation::open(Request request) {
  std::shared_ptr<EmbeddedSimulation> made(new EmbeddedSimulation());
  Result<void> built;
  made->owner_.run([&] {
    try {
      built = made->build(request);
    } catch (...) {
      built = refuse(C3DE_E_EXCEPTION, textOfException());
    }
  });
  if (!built) return tl::unexpected(built.error());
  return made;
}

EmbeddedSimulation::~EmbeddedSimulation() {
  owner_.run([this] {
    if (session_) (void)finishRecording();
    parameters_.reset();
    if (session_) session_->closeSimulation();
    simulator_.reset();
    session_.reset();
  });
}

Result<void> EmbeddedSimulation::build(const Request &request) {
  auto session = session::Session::create(request.options.session);
  if (!session) return refuse(session.error());
  session_ = std::move(*session);
  session::RunOptions options = request.options;
  options.overrides.clear();
  auto beginning = session::readBeginning(options, *session_, request.progress);
  if (!beginning) return refuse(beginning.error());
  auto scene = sceneToBuild(beginning->source, request.options.overrides, session_->materials());
  if (!scene) return refuse(scene.error());
  beginning->source.front() = *scene;
  const auto chosen = session_->chooseSimulator((*scene)->simulatorClass);
  if (!chosen) return refuse(chosen.error());
  if (beginning->replay)
    if (const auto same = beginning->replay->checkSimulator(*chosen); !same) return refuse(same.error());
  auto begun = begin(request, *beginning, *chosen);
  replay_ = std::move(beginning->replay);
  return begun;
}

Result<void> EmbeddedSimulation::begin(const Request &request, const session::RunBeginning &beginning,
                                       const session::SimulatorIdentity &chosen) {
  scene_ = std::get<SharedScene>(beginning.source.front());
  const scene::SceneFile &scene = *scene_;
  identity_ = chosen;
  auto created = session_->createSimulator(chosen.classId);
  if (!created) return refuse(created.error());
  simulator_.emplace(*created);
  const auto table = session::simulatorTable(simulator_->get());
  if (!table) return refuse(table.error());
  table_ = *table;
  session::BodySources sources;
  auto built = session::buildScene(*session_, simulator_->get(), scene, sources, request.progress, &facts_.prepared);
  if (built)
    built = session::buildRemaining(*session_, simulator_->get(), beginning.source, request.progress, &facts_.prepared);
  if (!built) return refuse(built.error());
  session::lendImage(*session_, scene, sources);
  if (scene.image) sources_ = std::move(sources);
  session_->keepInUse(beginning.files);
  if (beginning.saved)
    if (auto restored =
            session::restoreSession(*session_, simulator_->get(), chosen, *beginning.saved, request.options.scene);
        !restored)
      return refuse(restored.error());
  auto parameters = session::LiveParameters::create(*session_, simulator_->get(), beginning.source);
  if (!parameters) return refuse(parameters.error());
  parameters_.emplace(std::move(*parameters));
  if (auto adopted = session_->adoptForRun(simulator_->get(), scene.title, beginning.source); !adopted)
    return refuse(adopted.error());
  facts_.scene = scene.title;
  facts_.source = request.options.scene.string();
  facts_.simulator = chosen;
  facts_.threads = session_->pool().threadCount();
  return readStatus();
}

Failure EmbeddedSimulation::reason(const std::string &what, c3de_status code) {
  const std::string text = session_->plugins().takeError();
  return {code, what + ": " + (text.empty() ? fmt::format("status {}", code) : text)};
}

void EmbeddedSimulation::stateChanged() {
  ++generation_;
  listed_.clear();
  events_.reset();
  report_.reset();
}

Result<void> EmbeddedSimulation::readStatus() {
  const auto status = session::simulatorStatus(table_, simulator_->get());
  if (!status) return refuse(status.error());
  status_ = *status;
  facts_.isLoadStepped = (status_.flags & C3DE_SIM_LOAD_STEPS) != 0;
  return {};
}

Result<c3de_embed_status> EmbeddedSimulation::status() {
  const Use use(*this, Use::Access::cached);
  if (use.isRefused()) return use.refusal();
  c3de_embed_status out{};
  out.size = sizeof out;
  out.flags = (facts_.isLoadStepped ? C3DE_EMBED_LOAD_STEPS : 0u) | (status_.finished != 0 ? C3DE_EMBED_FINISHED : 0u);
  out.steps = status_.steps;
  out.time_s = status_.time_s;
  out.dt_s = status_.dt_s;
  out.bodies = status_.bodies;
  out.generation = generation_;
  out.stopped = status_.stopped;
  out.planned_steps = status_.planned_steps;
  out.wall_s = facts_.wall_s;
  return out;
}

bool EmbeddedSimulation::isDone(const Run &run, std::uint64_t made, bool repeats) const {
  if (repeats ? replay_->isAtEnd() : status_.finished != 0) return true;
  if (run.maxSteps != 0 && made >= run.maxSteps) return true;
  if (facts_.isLoadStepped) return false;
  if (run.until_s > 0.0) return status_.time_s >= run.until_s - kTimeTolerance * status_.dt_s;
  return !repeats && run.maxSteps == 0 && status_.time_s >= session::kDefaultDuration_s - kTimeTolerance * status_.dt_s;
}

double EmbeddedSimulation::fraction(const Run &run, std::uint64_t made) const {
  const auto part = [](double of, double all) { return all > 0.0 ? std::min(of / all, 1.0) : 0.0; };
  double done = 0.0;
  if (run.maxSteps != 0) done = part(static_cast<double>(made), static_cast<double>(run.maxSteps));
  if (facts_.isLoadStepped) return std::max(done, part(static_cast<double>(status_.steps), status_.planned_steps));
  if (run.maxSteps != 0 && run.until_s <= 0.0) return done;
  return std::max(done, part(status_.time_s, run.until_s > 0.0 ? run.until_s : session::kDefaultDuration_s));
}

Result<void> EmbeddedSimulation::makeOneStep(const char *owner) {
  const c3de_sim_status before = status_;
  const double cpuBegin_s = processorTime_s();
  const Clock::time_point begin = Clock::now();
  const auto code = session::makeStep(*session_->simulation(), owner);
  if (!code) return refuse(code.error());
  const double step_s = secondsSince(begin);
  facts_.wall_s += step_s;
  facts_.cpu_s += processorTime_s() - cpuBegin_s;
  stateChanged();
  if (*code < 0) {
    const std::string text = session_->plugins().takeError();
    discardSolverMemory();
    return refuse(*code, session::stepFailure(before.steps, before.time_s, facts_.isLoadStepped, *code, text));
  }
  facts_.stepTimes.add(1e3 * step_s);
  if (facts_.firstStep_s == 0.0) facts_.firstStep_s = step_s;
  session_->simulation()->endStep();
  if (auto read = readStatus(); !read) return read;
  if (status_.steps == before.steps && status_.time_s == before.time_s && status_.finished == 0)
    return refuse(C3DE_E_INTERNAL, "the simulator reports a step, but neither step count nor time has advanced");
  return {};
}

Failure EmbeddedSimulation::cancelled() const {
  return {C3DE_E_CANCELLED, facts_.isLoadStepped ? fmt::format("cancelled at load step {}", status_.steps)
                                                 : fmt::format("cancelled at {} s, after step {}",
                                                               formatNumber(status_.time_s), status_.steps)};
}

// What a solver keeps from a failed or cancelled step depends on how far the step had advanced. After the present state
// has been loaded, later steps follow from it alone, also in a replay.
void EmbeddedSimulation::discardSolverMemory() {
  const auto bytes = session::stateBytes(*session_, simulator_->get(), identity_);
  const auto loaded = bytes ? session::goToState(*session_, simulator_->get(), identity_, *bytes, "the present state")
                            : Expected<void>(tl::unexpected(bytes.error()));
  if (loaded) {
    if (recorder_) recorder_->addState(status_.steps, *bytes);
    return;
  }
  (void)session_->plugins().takeError();
  if (!recorder_) return;
  (void)finishRecording();
  recordingFailure_ = refuse(loaded.error()).value();
  recordingFailure_->text = fmt::format("the recording ends at step {}, after a failed or cancelled step: {}",
                                        status_.steps, recordingFailure_->text);
}

Result<void> EmbeddedSimulation::run(const Run &run, std::uint64_t &made) {
  made = 0;
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  return makeSteps(run, made, false);
}

Result<void> EmbeddedSimulation::makeSteps(const Run &run, std::uint64_t &made, bool repeats) {
  const Running running(*this);
  const char *owner = session_->plugins().ownerOf(simulator_->get());
  Clock::time_point lastCall = Clock::now();
  for (;;) {
    if (repeats)
      if (auto repeated = repeatDue(); !repeated) return repeated;
    if (isDone(run, made, repeats)) break;
    if (running.isOver()) return tl::unexpected(cancelled());
    const std::uint64_t before = status_.steps;
    if (auto step = makeOneStep(owner); !step) {
      if (step.error().code == C3DE_E_CANCELLED && running.isOver()) return tl::unexpected(cancelled());
      return step;
    }
    ++made;
    if (repeats) {
      if (status_.steps == before)
        return refuse(C3DE_E_STATE, fmt::format("the simulation ends at step {}, and the recording has more at step {}",
                                                before, replay_->nextStep()));
      replay_->countStep();
    }
    if (!run.stepped || secondsSince(lastCall) < run.every_s) continue;
    lastCall = Clock::now();
    if (!run.stepped(*status(), repeats ? replay_->fraction() : fraction(run, made)))
      return tl::unexpected(cancelled());
  }
  if (run.failsWithStoppedBodies && !repeats && status_.stopped > 0)
    return refuse(C3DE_E_DIVERGED, fmt::format("{} {} stopped early; the events state which, where and what would help",
                                               status_.stopped, status_.stopped == 1 ? "body has" : "bodies have"));
  return {};
}

void EmbeddedSimulation::cancel() {
  const std::lock_guard lock(cancelMutex_);
  if (!isRunning_ || isCancelled_) return;
  isCancelled_ = true;
  if (session::endsSteps(table_)) (void)table_->interrupt(simulator_->get(), 1);
}

Result<void> EmbeddedSimulation::close() {
  // Only the thread of a callback gets the lock while a call is active.
  if (const std::unique_lock own(mutex_, std::try_to_lock); own && isInCall_)
    return Use(*this, Use::Access::write).refusal();
  if (isClosing_.exchange(true)) return refuse(C3DE_E_STALE, "the simulation has been closed");
  cancel();
  const std::lock_guard last(mutex_);
  return {};
}

Result<void> EmbeddedSimulation::reset() {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const c3de_status code = callPluginFunction(session_->plugins().ownerOf(simulator_->get()), "reset of the simulation",
                                              CallKind::step, [this] { return table_->reset(simulator_->get()); });
  stateChanged();
  if (code < 0) return tl::unexpected(reason("the reset failed", code));
  if (recorder_) recorder_->addReset(status_.steps);
  return readStatus();
}

Result<std::uint64_t> EmbeddedSimulation::stateHash() {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto hash = session::stateHash(table_, simulator_->get());
  if (!hash) return refuse(hash.error());
  return *hash;
}

Result<std::uint64_t> EmbeddedSimulation::parameterCount() {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (listed_.empty()) listed_ = parameters_->all();
  return listed_.size();
}

Result<c3de_embed_parameter> EmbeddedSimulation::parameterAt(std::uint64_t index) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (listed_.empty()) listed_ = parameters_->all();
  if (index >= listed_.size())
    return refuse(C3DE_E_NOT_FOUND, fmt::format("parameter {}: accepted: below {}", index, listed_.size()));
  const auto &[path, decl] = listed_[index];
  c3de_embed_parameter out{};
  out.size = sizeof out;
  out.type = decl.type;
  out.path = intern(path);
  out.unit = intern(decl.unit);
  out.label = intern(decl.label);
  out.meaning = intern(decl.doc);
  out.accepted = intern(decl.accepted());
  return out;
}

Result<c3de_embed_value> EmbeddedSimulation::get(const std::string &path) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto value = parameters_->get(path);
  if (!value) return refuse(value.error());
  c3de_embed_value out{};
  out.size = sizeof out;
  out.type = value->type;
  out.number = value->num;
  for (std::size_t axis = 0; axis < 3; ++axis) out.vector[axis] = value->vec[axis];
  const bool isText = value->type == C3DE_PARAM_CHOICE || value->type == C3DE_PARAM_TEXT;
  out.text = intern(isText ? value->text : value->display());
  return out;
}

Result<void> EmbeddedSimulation::set(const std::string &path, const std::string &text) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto done = parameters_->set(path, text);
  stateChanged();
  if (!done) return refuse(done.error());
  return readStatus();
}

}  // namespace c3de::embed
