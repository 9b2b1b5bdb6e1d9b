// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <future>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "c3de/core/log.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "c3de/core/thread_priority.h"
#include "c3de/scene/simulator_table.h"
#include "c3de/scene/text_sink.h"
#include "pace.h"

namespace c3de::scene {
namespace {

/// More frequent snapshots would not be visible.
constexpr auto kPublishInterval = std::chrono::milliseconds(8);
/// Steps due within this interval are computed together, because waking up for every small time step costs more.
constexpr auto kShortestSleep = std::chrono::milliseconds(2);

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

struct Simulation::Impl {
  c3de_object *object = nullptr;
  const c3de_simulator_v1 *table = nullptr;
  std::function<std::string()> takeError;
  const char *owner = "";  ///< the plugin's id

  std::mutex queueMutex;
  std::condition_variable wake;
  struct Command {
    std::function<void()> run;
    bool isUrgent = false;  ///< the result being computed is no longer wanted
  };
  std::vector<Command> queue;
  std::size_t urgent = 0;  ///< waiting commands
  bool stopping = false;

  mutable std::mutex stateMutex;
  c3de_sim_transport shown{};
  Meter::Rates rates;
  Clock::time_point stepBegan{};  ///< start of the step in progress; otherwise none
  std::string failureText;
  AbortedSteps abortedSteps;
  const PluginCall *running = nullptr;  ///< the call in progress
  std::string activityBefore;

  std::mutex listenerMutex;
  std::function<void()> listener;

  // The following members belong to the simulation's thread.
  std::uint32_t mode = C3DE_SIM_STOPPED;
  double targetRate = 1.0;
  c3de_sim_status status{};
  std::string failure;
  Pace pace;
  Meter meter;
  bool advancing = true;    ///< the last step changed something; an empty world may have nothing to compute
  bool unpublished = true;  ///< the state has changed since the last snapshot
  Clock::time_point publishedAt{};
  std::function<Expected<void>()> beforeStep;
  std::function<void(const c3de_sim_status &)> afterStep, afterReset;

  bool isSteppedByCaller = false;
  std::thread thread;

  ~Impl();
  void run();
  void enqueue(std::function<void()> command, bool isUrgent = false);
  bool runCommands(std::vector<Command> &commands);
  void runWaiting();
  void begin(Command &command);
  void interrupt(bool raised);
  template <class F>
  c3de_status call(const char *what, F &&f);
  void apply(std::uint32_t action);
  void play();
  void goToInitialState(bool goOnPlaying);
  void step();
  void publish();
  void readStatus();
  void show();
  void failWith(const std::string &what, c3de_status code);
};

Simulation::Impl::~Impl() {
  if (thread.joinable()) {
    {
      const std::lock_guard lock(queueMutex);
      stopping = true;
      interrupt(true);
    }
    wake.notify_one();
    thread.join();
    interrupt(false);
  } else if (table != nullptr) {
    runWaiting();
  }
  releaseObject(object);
}

/// Calls a function of the table that may take long.
template <class F>
c3de_status Simulation::Impl::call(const char *what, F &&f) {
  return callPluginFunction(owner, what, CallKind::step, [&](const PluginCall &recorded) {
    const auto note = [this](const PluginCall *now) {
      const std::lock_guard lock(stateMutex);
      running = now;
    };
    note(&recorded);
    struct AtEnd {
      decltype(note) &noteEnd;
      ~AtEnd() { noteEnd(nullptr); }
    } const atEnd{note};
    return f();
  });
}

/// Called with the queue mutex held, so that the flag stays raised while anything urgent waits.
void Simulation::Impl::interrupt(bool raised) {
  if (table->interrupt != nullptr) table->interrupt(object, raised ? 1u : 0u);
}

void Simulation::Impl::enqueue(std::function<void()> command, bool isUrgent) {
  {
    const std::lock_guard lock(queueMutex);
    queue.push_back({std::move(command), isUrgent});
    if (isUrgent && ++urgent == 1) interrupt(true);
  }
  wake.notify_one();
}

/// Clears the interrupt when the last urgent command begins.
void Simulation::Impl::begin(Command &command) {
  if (!command.isUrgent) return;
  const std::lock_guard lock(queueMutex);
  if (--urgent == 0 && !stopping) interrupt(false);
}

void Simulation::Impl::run() {
  lowerThreadPriority();
  publish();
  std::vector<Command> commands;
  for (;;) {
    // Commands first: they take effect between two steps.
    bool stop = false;
    {
      std::unique_lock lock(queueMutex);
      if (mode != C3DE_SIM_PLAYING) {
        wake.wait(lock, [this] { return stopping || !queue.empty(); });
      } else {
        const Clock::time_point now = Clock::now();
        Clock::time_point due = now;
        if (!advancing)
          due = now + kPublishInterval;
        else if (targetRate > 0.0)
          due = pace.dueTime(status.time_s + status.dt_s, targetRate, now);
        if (due > now)
          wake.wait_until(lock, std::max(due, now + kShortestSleep), [this] { return stopping || !queue.empty(); });
      }
      commands.swap(queue);
      stop = stopping;
    }
    const bool commanded = runCommands(commands);
    if (stop) break;

    // Then the steps that are due, unless a command has arrived.
    if (mode == C3DE_SIM_PLAYING) {
      const Clock::time_point now = Clock::now();
      if (targetRate <= 0.0 || pace.dueTime(status.time_s + status.dt_s, targetRate, now) <= now) step();
    }
    if (unpublished && (commanded || mode != C3DE_SIM_PLAYING || Clock::now() - publishedAt >= kPublishInterval))
      publish();
    else
      show();
  }
}

/// True if there were any commands.
bool Simulation::Impl::runCommands(std::vector<Command> &commands) {
  if (commands.empty()) return false;
  const c3de_sim_status before = status;
  for (Command &command : commands) {
    begin(command);
    try {
      command.run();
    } catch (const std::exception &error) {
      log(LogLevel::error, std::string("a command to the simulation failed: ") + error.what());
    } catch (...) {
      log(LogLevel::error, "a command to the simulation failed");
    }
  }
  commands.clear();
  readStatus();
  // A command may have added a body, which restarts at time 0.
  if (status.time_s != before.time_s) pace.start(Clock::now(), status.time_s);
  if (mode == C3DE_SIM_FAILED && before.failed != 0 && status.failed == 0) {
    mode = C3DE_SIM_PAUSED;  // an earlier state was restored
    failure.clear();
  }
  unpublished = true;
  return true;
}

void Simulation::Impl::runWaiting() {
  std::vector<Command> waiting;
  {
    const std::lock_guard lock(queueMutex);
    waiting.swap(queue);
  }
  (void)runCommands(waiting);
}

void Simulation::Impl::apply(std::uint32_t action) {
  if (isSteppedByCaller) return;
  switch (action) {
    case C3DE_TRANSPORT_PLAY:
      if (mode == C3DE_SIM_STOPPED || mode == C3DE_SIM_PAUSED) play();
      break;
    case C3DE_TRANSPORT_PAUSE:
      if (mode != C3DE_SIM_PLAYING) break;
      mode = C3DE_SIM_PAUSED;
      meter.pause();
      break;
    case C3DE_TRANSPORT_STOP: goToInitialState(false); break;
    case C3DE_TRANSPORT_RESET: goToInitialState(mode == C3DE_SIM_PLAYING); break;
    case C3DE_TRANSPORT_STEP:
      if (mode == C3DE_SIM_FAILED) break;
      mode = C3DE_SIM_PAUSED;
      step();
      meter.pause();
      break;
    default: log(LogLevel::warn, "unknown transport action " + std::to_string(action) + " ignored; known: 1 to 5");
  }
}

void Simulation::Impl::play() {
  mode = C3DE_SIM_PLAYING;
  advancing = true;
  readStatus();
  pace.start(Clock::now(), status.time_s);
}

void Simulation::Impl::goToInitialState(bool goOnPlaying) {
  readStatus();  // an earlier command may have changed it
  const c3de_sim_status before = status;
  const c3de_status code = call("reset of the simulation", [this] { return table->reset(object); });
  unpublished = true;
  meter.clear();
  if (code < 0) {
    failWith("resetting to the initial state failed", code);
    return;
  }
  if (afterReset) afterReset(before);
  failure.clear();
  mode = C3DE_SIM_STOPPED;
  if (goOnPlaying) play();
}

void Simulation::Impl::step() {
  if (beforeStep)
    if (const auto ready = beforeStep(); !ready) {
      log(LogLevel::error, ready.error().message + "; the simulation pauses");
      mode = C3DE_SIM_PAUSED;
      meter.pause();
      return;
    }
  const double timeBefore_s = status.time_s;
  const std::uint64_t stepsBefore = status.steps;
  const Clock::time_point begin = Clock::now();
  {
    const std::lock_guard lock(stateMutex);
    stepBegan = begin;
  }
  const c3de_status code = call("a step of the simulation", [this] { return table->step(object); });
  const Clock::time_point end = Clock::now();
  {
    const std::lock_guard lock(stateMutex);
    stepBegan = {};
  }
  unpublished = true;
  readStatus();
  if (code == C3DE_E_CANCELLED) {
    // Another command is urgent; lost time is not made up for.
    meter.pause();
    pace.start(end, status.time_s);
    return;
  }
  if (code == C3DE_E_TIMEOUT) {
    mode = C3DE_SIM_PAUSED;
    meter.pause();
    std::string reason = takeError ? takeError() : std::string();
    if (reason.empty()) reason = "the step took longer than the simulator allows; the state before it stays";
    log(LogLevel::warn, reason);
    const std::lock_guard lock(stateMutex);
    ++abortedSteps.steps;
    abortedSteps.why = reason;
    return;
  }
  if (code < 0) {
    meter.pause();
    failWith("step " + std::to_string(status.steps + 1) + " at " + formatNumber(status.time_s) + " s failed", code);
    return;
  }
  // A body added by another thread meanwhile resets time to 0.
  if (status.time_s < timeBefore_s) pace.start(end, status.time_s);
  // A quasi-static solution has steps but no time; an empty world may count steps that compute nothing.
  advancing = status.time_s != timeBefore_s || (status.steps != stepsBefore && status.bodies > 0);
  meter.add(end, seconds(end - begin), std::max(0.0, status.time_s - timeBefore_s));
  if (afterStep) afterStep(status);
  if (status.finished != 0 && mode == C3DE_SIM_PLAYING) {
    mode = C3DE_SIM_PAUSED;
    meter.pause();
  }
}

void Simulation::Impl::publish() {
  const c3de_status code = call("publish of the simulation", [this] { return table->publish(object); });
  unpublished = false;
  publishedAt = Clock::now();
  if (code < 0 && mode != C3DE_SIM_FAILED) failWith("publishing a snapshot failed", code);
  // The listener may draw at once and then wait for the next snapshot, so its state must be that of this one.
  show();
  const std::lock_guard lock(listenerMutex);
  if (listener) listener();
}

void Simulation::Impl::readStatus() {
  c3de_sim_status now{};
  now.size = sizeof now;
  if (table->status(object, &now) >= 0) status = now;
}

void Simulation::Impl::show() {
  const std::lock_guard lock(stateMutex);
  shown.size = sizeof shown;
  shown.mode = mode;
  shown.steps = status.steps;
  shown.time_s = status.time_s;
  shown.target_rate = targetRate;
  rates = meter.rates();
  failureText = failure;
}

void Simulation::Impl::failWith(const std::string &what, c3de_status code) {
  const std::string reason = takeError ? takeError() : std::string();
  mode = C3DE_SIM_FAILED;
  failure = what + ": " + (reason.empty() ? "the simulator answered status " + std::to_string(code) : reason);
  log(LogLevel::error, failure);
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::~Simulation() = default;

Expected<std::unique_ptr<Simulation>> Simulation::createForCaller(c3de_object *simulator,
                                                                  std::function<std::string()> takeError,
                                                                  const char *owner) {
  if (simulator == nullptr) return fail(ErrorCode::internal, "no simulator object was given");
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  auto impl = std::make_unique<Impl>();
  simulator->vt->retain(simulator);
  impl->object = simulator;
  impl->table = *table;
  impl->takeError = std::move(takeError);
  impl->owner = owner;
  impl->isSteppedByCaller = true;
  impl->show();
  return std::unique_ptr<Simulation>(new Simulation(std::move(impl)));
}

Expected<std::unique_ptr<Simulation>> Simulation::create(c3de_object *simulator, std::function<std::string()> takeError,
                                                         const char *owner) {
  auto made = createForCaller(simulator, std::move(takeError), owner);
  if (!made) return made;
  Impl *impl = (*made)->impl_.get();
  impl->isSteppedByCaller = false;
  impl->readStatus();
  if (impl->status.steps > 0) impl->mode = C3DE_SIM_PAUSED;  // it continues from a saved state
  impl->show();
  impl->thread = std::thread([impl] { impl->run(); });
  return made;
}

bool Simulation::isSteppedByCaller() const { return impl_->isSteppedByCaller; }

Expected<void> Simulation::beginStep() {
  impl_->runWaiting();
  return impl_->beforeStep ? impl_->beforeStep() : Expected<void>();
}

void Simulation::endStep() {
  impl_->readStatus();
  impl_->show();
  if (impl_->afterStep) impl_->afterStep(impl_->status);
}

void Simulation::setAfterStep(std::function<void(const c3de_sim_status &)> follow) {
  post([impl = impl_.get(), follow = std::move(follow)] { impl->afterStep = follow; });
}

void Simulation::setAfterReset(std::function<void(const c3de_sim_status &)> follow) {
  post([impl = impl_.get(), follow = std::move(follow)] { impl->afterReset = follow; });
}

void Simulation::transport(std::uint32_t action) {
  bool isUrgent = action == C3DE_TRANSPORT_STOP || action == C3DE_TRANSPORT_RESET;
  if (action == C3DE_TRANSPORT_PAUSE) {
    // A single step requested just before is still made.
    const std::lock_guard lock(impl_->stateMutex);
    isUrgent = impl_->stepBegan != Clock::time_point{};
  }
  impl_->enqueue([impl = impl_.get(), action] { impl->apply(action); }, isUrgent);
}

void Simulation::setTargetRate(double rate) {
  const double accepted = std::isfinite(rate) && rate > 0.0 ? rate : 0.0;
  impl_->enqueue([impl = impl_.get(), accepted] {
    impl->targetRate = accepted;
    impl->pace.start(Clock::now(), impl->status.time_s);
    impl->meter.clear();
  });
}

void Simulation::setBeforeStep(std::function<Expected<void>()> prepare) {
  post([impl = impl_.get(), prepare = std::move(prepare)] { impl->beforeStep = prepare; });
}

void Simulation::post(std::function<void()> command) {
  if (command) impl_->enqueue(std::move(command));
}

void Simulation::call(const std::function<void()> &command) {
  if (!command) return;
  if (impl_->isSteppedByCaller || std::this_thread::get_id() == impl_->thread.get_id()) {
    command();
    return;
  }
  std::promise<void> done;
  impl_->enqueue([&command, &done, impl = impl_.get()] {
    try {
      command();
      impl->readStatus();
      impl->show();
      done.set_value();
    } catch (...) {
      done.set_exception(std::current_exception());
    }
  });
  done.get_future().get();
}

c3de_sim_transport Simulation::state() const {
  const std::lock_guard lock(impl_->stateMutex);
  c3de_sim_transport state = impl_->shown;
  if (impl_->stepBegan != Clock::time_point{}) state.step_running_s = seconds(Clock::now() - impl_->stepBegan);
  state.real_time_factor = impl_->rates.realTimeFactor(state.step_running_s);
  state.step_ms = 1e3 * impl_->rates.step_s(state.step_running_s);
  return state;
}

std::string Simulation::activity() const {
  const c3de_simulator_v1 *table = impl_->table;
  if (table->activity == nullptr) return {};
  std::string text;
  if (table->activity(impl_->object, sinkInto(text)) < 0) return {};
  const std::lock_guard lock(impl_->stateMutex);
  if (impl_->running != nullptr && text != impl_->activityBefore) impl_->running->noteProgress();
  impl_->activityBefore = text;
  return displayText(text);
}

std::string Simulation::failure() const {
  const std::lock_guard lock(impl_->stateMutex);
  return impl_->failureText;
}

Simulation::AbortedSteps Simulation::abortedSteps() const {
  const std::lock_guard lock(impl_->stateMutex);
  return impl_->abortedSteps;
}

void Simulation::setPublishedListener(std::function<void()> listener) {
  const std::lock_guard lock(impl_->listenerMutex);
  impl_->listener = std::move(listener);
}

c3de_object *Simulation::object() const { return impl_->object; }
const c3de_simulator_v1 *Simulation::table() const { return impl_->table; }

}  // namespace c3de::scene
