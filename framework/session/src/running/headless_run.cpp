// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/headless_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/simulation_step.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/step_limit.h"

namespace c3de::session {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kEnergyRows = 200.0;  // per run

/// For the user: 0.0984 rather than 0.09838074452694451.
std::string threeDigits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

}  // namespace

Expected<std::string> HeadlessRun::simulatorReport() const {
  std::string text;
  const c3de_status code = table_->report(simulator_, scene::sinkInto(text));
  if (code >= 0) return text;
  const std::string reason = session_.plugins().takeError();
  return fail(ErrorCode::plugin,
              "the simulator gives no report: " + (reason.empty() ? "status " + std::to_string(code) : reason));
}

Expected<void> HeadlessRun::readStatus() {
  const auto status = simulatorStatus(table_, simulator_);
  if (!status) return tl::unexpected(status.error());
  facts_.steps = status->steps;
  facts_.time_s = status->time_s;
  facts_.dt_s = status->dt_s;
  bodies_ = status->bodies;
  finished_ = status->finished != 0;
  stopped_ = status->stopped;
  facts_.isLoadStepped = (status->flags & C3DE_SIM_LOAD_STEPS) != 0;
  plannedSteps_ = status->planned_steps;
  return {};
}

bool HeadlessRun::isDone() const {
  if (replay_ != nullptr ? replay_->isAtEnd() : finished_) return true;
  if (options_.steps) return facts_.steps >= *options_.steps;
  if (isQuasistatic() || (replay_ != nullptr && !options_.until_s)) return false;
  // The sum of many steps may be slightly below the end; the remainder is not a step.
  const double until_s = options_.until_s.value_or(kDefaultDuration_s);
  return facts_.time_s >= until_s - 1e-6 * facts_.dt_s;
}

double HeadlessRun::fraction() const {
  if (replay_ != nullptr) return replay_->fraction();
  const auto steps = static_cast<double>(facts_.steps);
  if (options_.steps) return steps / static_cast<double>(*options_.steps);
  if (isQuasistatic()) return plannedSteps_ > 0 ? steps / plannedSteps_ : 0.0;
  return facts_.time_s / options_.until_s.value_or(kDefaultDuration_s);
}

std::string HeadlessRun::position() const {
  if (isQuasistatic()) return "load step " + std::to_string(facts_.steps);
  return formatNumber(facts_.time_s) + " s";
}

Expected<void> HeadlessRun::addFrame() {
  const auto states =
      readBodyStates(simulator_, BodyParts::skinAndInside, [this] { return session_.plugins().takeError(); });
  if (!states) return tl::unexpected(states.error());
  return export_->addFrame(isQuasistatic() ? static_cast<double>(facts_.steps) : facts_.time_s, *states);
}

void HeadlessRun::exportFrame(bool isEnd) {
  if (!export_ || exportedStep_ == facts_.steps) return;
  const double from_s = options_.from_s.value_or(0.0);
  if (options_.from_s && facts_.time_s < from_s - 1e-6 * facts_.dt_s) {
    if (!isEnd || exportedStep_) return;
    outputs_.addFailure(options_.exportList, {ErrorCode::usage, "--from " + formatNumber(from_s) +
                                                                    " s: the replay ends before, at " + position()});
    export_.reset();
    return;
  }
  // The sum of many steps may be slightly below the time of a frame. Load steps have no time: each is a frame.
  const bool isDue = isQuasistatic() || facts_.time_s >= nextFrame_s_ - 1e-6 * facts_.dt_s;
  if (!isDue && !isEnd) return;
  if (const auto added = addFrame(); !added) {
    outputs_.addFailure(
        options_.exportList,
        {added.error().code, added.error().message + "; earlier frames are kept, and the run continues"});
    export_.reset();
    return;
  }
  exportedStep_ = facts_.steps;
  if (isDue)
    nextFrame_s_ =
        from_s + options_.exportEvery_s *
                     (std::floor((facts_.time_s - from_s + 1e-6 * facts_.dt_s) / options_.exportEvery_s) + 1.0);
}

Expected<void> HeadlessRun::sampleProbes() {
  sampledStep_ = facts_.steps;
  const auto samples = readProbes(table_, simulator_);
  if (!samples) return tl::unexpected(samples.error());
  const auto tools = readProbeTools(simulator_);
  if (!tools) return tl::unexpected(tools.error());
  Expected<void> written;
  if (!probes_) {
    auto created = ProbeTable::create(options_.probes, *samples, *tools);
    if (created)
      probes_ = std::move(*created);
    else
      written = tl::unexpected(created.error());
  }
  if (written) written = probes_->add(facts_.time_s, *samples, *tools);
  if (!written) {
    outputs_.addFailure(
        options_.probes,
        {written.error().code, written.error().message + "; the whole rows before it are kept, and the run goes on"});
    wantsProbes_ = false;
  }
  return {};
}

void HeadlessRun::sampleEnergies(bool isEnd) {
  if (!wantsEnergies_ || energyStep_ == facts_.steps) return;
  // A report may take as long as many steps.
  const double row = energies_ ? std::floor(kEnergyRows * fraction()) : 0.0;
  if (!isEnd && energies_ && row <= energyRow_) return;
  energyRow_ = row;
  energyStep_ = facts_.steps;
  const auto report = simulatorReport();
  Expected<void> written;
  if (!report) {
    written = tl::unexpected(report.error());
  } else if (!energies_) {
    auto created = EnergyTable::create(options_.energies, *report);
    if (created)
      energies_ = std::move(*created);
    else
      written = tl::unexpected(created.error());
  }
  if (written) written = energies_->add(facts_.time_s, *report);
  if (written) return;
  outputs_.addFailure(
      options_.energies,
      {written.error().code, written.error().message + "; the whole rows before it are kept, and the run goes on"});
  wantsEnergies_ = false;
}

void HeadlessRun::finishOutputs() {
  if (recorder_) {
    session_.setRecorder(nullptr);
    outputs_.note(options_.record, recorder_->finish());
  }
  if (export_) outputs_.note(options_.exportList, export_->finish());
  if (wantsEnergies_ && energies_) outputs_.note(options_.energies, energies_->close());
  if (wantsProbes_ && probes_) outputs_.note(options_.probes, probes_->close());
}

Expected<void> HeadlessRun::beginOutputs() {
  wantsProbes_ = !options_.probes.empty();
  if (wantsProbes_)
    if (const auto sampled = sampleProbes(); !sampled) return sampled;
  if (!options_.exportList.empty()) export_ = std::make_unique<SimulationExport>(options_.exportList);
  exportFrame(false);
  wantsEnergies_ = !options_.energies.empty();
  sampleEnergies(false);
  if (!options_.report.empty())
    if (auto start = simulatorReport()) facts_.startReport = std::move(*start);
  return {};
}

void HeadlessRun::endWith(const char *outcome, std::string failure) {
  facts_.outcome = outcome;
  facts_.failure = std::move(failure);
}

bool HeadlessRun::isPastDeadline() const { return limits_.deadline && Clock::now() >= *limits_.deadline; }

bool HeadlessRun::endsByLimit() {
  if (wasInterrupted()) {
    endWith("interrupted", "interrupted at " + position());
    return true;
  }
  if (!isPastDeadline()) return false;
  endWith("time_limit", "the time limit of " + formatNumber(*options_.timeLimit_s) + " s was reached at " + position());
  return true;
}

Expected<c3de_status> HeadlessRun::timedStep(scene::Simulation &simulation, const char *owner, double &step_s) {
  const double cpuBegin_s = processorTime_s();
  const Clock::time_point begin = Clock::now();
  const auto code = makeStep(simulation, owner);
  if (!code) return code;
  step_s = std::chrono::duration<double>(Clock::now() - begin).count();
  facts_.wall_s += step_s;
  facts_.cpu_s += processorTime_s() - cpuBegin_s;
  if (facts_.firstStep_s == 0.0) {
    facts_.firstStep_s = facts_.wall_s;
    facts_.toFirstStep_s = std::chrono::duration<double>(Clock::now() - limits_.begin).count();
  }
  return code;
}

Expected<bool> HeadlessRun::repeatDue() {
  if (replay_ == nullptr) return true;
  const ProgressFn progress = [](double, const std::string &) { return !wasInterrupted(); };
  if (const auto applied = replay_->applyDueEvents(session_, simulator_, table_, session_.changes(), progress);
      !applied)
    return tl::unexpected(applied.error());
  if (const auto read = readStatus(); !read) return tl::unexpected(read.error());
  if (replay_->difference().empty()) return true;
  endWith("differs", replay_->difference());
  return false;
}

bool HeadlessRun::endsAtStandstill(std::uint64_t stepsBefore, double timeBefore_s) {
  if (facts_.steps != stepsBefore || facts_.time_s != timeBefore_s) return false;
  if (replay_ != nullptr)
    endWith("failed", "the simulation ends at step " + std::to_string(facts_.steps) +
                          ", and the recording has more at step " + std::to_string(replay_->nextStep()));
  else if (!finished_)
    endWith("failed", "the simulator reports a step, but neither step count nor time has advanced");
  return facts_.outcome == "failed";
}

/// A recording that has failed is reported at once; the run continues.
void HeadlessRun::noteRecording() {
  if (!recorder_ || !recorder_->hasFailed()) return;
  session_.setRecorder(nullptr);
  outputs_.note(options_.record, recorder_->finish());
  recorder_.reset();
}

Expected<void> HeadlessRun::stepToEnd(ProgressLine &progress) {
  scene::Simulation &simulation = *session_.simulation();
  const char *owner = session_.plugins().ownerOf(simulator_);
  const StepLimit limit(simulator_, table_, limits_.deadline);
  facts_.outcome = "done";
  int tenths = 0;  // completed tenths that --verbose has printed
  const auto progressText = [this] {
    if (isQuasistatic()) return position() + " in " + threeDigits(facts_.wall_s) + " s";
    return threeDigits(facts_.time_s) + " s simulated in " + threeDigits(facts_.wall_s) + " s, step " +
           std::to_string(facts_.steps);
  };
  for (;;) {
    const auto repeated = repeatDue();
    if (!repeated) return tl::unexpected(repeated.error());
    if (!*repeated || isDone() || endsByLimit()) break;
    const std::uint64_t bodies = bodies_;
    const double timeBefore_s = facts_.time_s;
    const std::uint64_t stepsBefore = facts_.steps;
    double step_s = 0.0;
    const auto code = timedStep(simulation, owner, step_s);
    if (!code) {
      endWith("failed", code.error().message);
      break;
    }
    if (*code == C3DE_E_CANCELLED) {
      (void)session_.plugins().takeError();
      // By the limit or by a signal: the check at the top of the loop determines which.
      if (wasInterrupted() || isPastDeadline()) continue;
    }
    if (*code < 0) {
      const std::string reason = session_.plugins().takeError();
      endWith(*code == C3DE_E_DIVERGED ? "diverged" : "failed",
              stepFailure(stepsBefore, timeBefore_s, isQuasistatic(), *code, reason));
      break;
    }
    facts_.stepTimes.add(1e3 * step_s);
    simulation.endStep();
    if (replay_ != nullptr) replay_->countStep();
    noteRecording();
    if (const auto read = readStatus(); !read) return read;
    if (bodies_ < bodies) {
      endWith("failed", std::to_string(bodies - bodies_) + " of " + std::to_string(bodies) +
                            " bodies were removed while the simulation ran, after " + position() +
                            "; a plugin has done that");
      break;
    }
    if (endsAtStandstill(stepsBefore, timeBefore_s)) break;
    if (wantsProbes_ && facts_.steps % options_.probesEvery == 0)
      if (const auto sampled = sampleProbes(); !sampled) return sampled;
    exportFrame(false);
    sampleEnergies(false);
    if (progress.isDue()) progress.update(fraction(), progressText());
    if (const int tenth = static_cast<int>(10.0 * std::min(fraction(), 1.0)); tenth > tenths) {
      tenths = tenth;
      log(LogLevel::debug, std::to_string(10 * tenth) + " %: " + progressText());
    }
  }
  return {};
}

Expected<void> HeadlessRun::run() {
  facts_.threads = session_.pool().threadCount();
  facts_.seed = options_.seed;
  // This is the only simulation, and this function steps it.
  if (auto adopted = session_.adoptForRun(simulator_, options_.scene.stem().string(), std::move(source_)); !adopted)
    return adopted;
  if (recorder_) session_.setRecorder(recorder_);
  if (const auto read = readStatus(); !read) return read;
  if (const auto begun = beginOutputs(); !begun) return begun;
  ProgressLine progress(options_.quiet);
  if (const auto stepped = stepToEnd(progress); !stepped) return stepped;
  if (facts_.outcome == "done" && stopped_ > 0)
    endWith("diverged", std::to_string(stopped_) + (stopped_ == 1 ? " body" : " bodies") +
                            " stopped early; \"events\" in the report state which, where and what would help");
  // The end, whatever its cause, is the last row.
  if (wantsProbes_ && sampledStep_ != facts_.steps)
    if (const auto sampled = sampleProbes(); !sampled) return sampled;
  exportFrame(true);
  sampleEnergies(true);
  finishOutputs();
  const auto hash = stateHash(table_, simulator_);
  if (!hash) return tl::unexpected(hash.error());
  facts_.stateHash = *hash;
  return {};
}

}  // namespace c3de::session
