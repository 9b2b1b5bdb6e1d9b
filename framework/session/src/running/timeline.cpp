// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include "c3de/core/plugin_call.h"
#include "c3de/session/session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

// Changes of simulators that store their state.
constexpr std::string_view kStoresState = "state.store", kStoresCheckpoint = "checkpoint.store",
                           kRestoresCheckpoint = "checkpoint.exchange";
/// Loading a state takes about as long as these steps.
constexpr std::uint64_t kStepsOfRestoring = 25;

bool isPersistent(const RecordedEvent &event) {
  if (const auto *change = std::get_if<SimulationChange>(&event))
    return (change->flags & C3DE_SIM_CHANGE_TRANSIENT) == 0;
  return std::holds_alternative<RecordedScene>(event);
}

}  // namespace

Timeline::Timeline(Recording recording, std::filesystem::path file, SimulationSource source, TimelineOptions options)
    : replay_(std::move(recording), std::move(file), true), axis_(replay_.recording()), options_(options),
      keyframes_(options.keyframeBytes) {
  auto start = std::make_shared<Keyframe>();
  start->state = replay_.recording().start.session.state;
  start->source = std::make_shared<const SimulationSource>(std::move(source));
  start_ = std::move(start);
  indexChanges();
}

void Timeline::indexChanges() {
  const auto &events = recording().events;
  std::map<std::string_view, std::size_t> stored;
  persistent_.push_back(0);
  for (std::size_t i = 0; i < events.size(); ++i) {
    persistent_.push_back(persistent_.back() + (isPersistent(events[i]) ? 1 : 0));
    const auto *change = std::get_if<SimulationChange>(&events[i]);
    if (change == nullptr) continue;
    if (change->id == kStoresCheckpoint) stored[change->bytes] = i + 1;
    if (change->id == kRestoresCheckpoint) exchanges_.emplace_back(i, stored[change->bytes]);
  }
}

/// A checkpoint is not part of a state: whoever restores it must have repeated its change.
bool Timeline::isUsableUpTo(const Keyframe &keyframe, std::uint64_t made) const {
  return std::none_of(exchanges_.begin(), exchanges_.end(), [&](const auto &exchange) {
    return exchange.first >= keyframe.at.next && axis_.events()[exchange.first] <= made &&
           exchange.second <= keyframe.at.next;
  });
}

Timeline::Jump Timeline::jumpTo(std::uint64_t made) const {
  made = std::min(made, axis_.length());
  const std::uint64_t present = position();
  std::shared_ptr<const Keyframe> best =
      keyframes_.lastUpTo(made, [&](const Keyframe &one) { return isUsableUpTo(one, made); });
  if (origin_ && present <= made && (!best || best->at.made <= present + kStepsOfRestoring)) return {};
  if (!best) best = start_;
  const bool isSameScene = origin_ && persistent_[best->at.next] == persistent_[replay_.position().next];
  const bool mayRestore = isSameScene && !best->state.empty() && (best != start_ || mayRestoreStart_);
  return {mayRestore ? JumpKind::restore : JumpKind::rebuild, std::move(best)};
}

void Timeline::begin(std::shared_ptr<const Keyframe> keyframe, bool isRestored) {
  replay_.goTo(keyframe->at);
  storedAt_ = keyframe->at.made;
  origin_ = std::move(keyframe);
  isOriginRestored_ = isRestored;
  hasStoredSinceHash_ = false;
  lastHash_.reset();
}

void Timeline::rebuilt(std::shared_ptr<const Keyframe> keyframe) { begin(std::move(keyframe), false); }

Expected<void> Timeline::restore(const Target &target, std::shared_ptr<const Keyframe> keyframe) {
  auto restored = goToState(target.session, target.simulation.object(), recording().start.simulator, keyframe->state,
                            "the keyframe");
  if (restored) {
    begin(std::move(keyframe), true);
    return restored;
  }
  if (keyframe == start_)
    mayRestoreStart_ = false;
  else
    keyframes_.removeIf([&](const Keyframe &one) { return &one == keyframe.get(); });
  return restored;
}

/// Whether the recorded simulation stored its state at this position.
bool Timeline::isStoredHere() const {
  const auto &events = recording().events;
  for (std::size_t i = replay_.position().next; i > 0 && axis_.events()[i - 1] == position(); --i)
    if (const auto *change = std::get_if<SimulationChange>(&events[i - 1]); change && change->id == kStoresState)
      return true;
  return false;
}

bool Timeline::hasHashUpTo(std::uint64_t made) const {
  const auto &events = recording().events;
  for (std::size_t i = replay_.position().next; i < events.size() && axis_.events()[i] <= made; ++i)
    if (hashOf(events[i]) != nullptr && axis_.events()[i] > position()) return true;
  return false;
}

void Timeline::storeIfDue(const Target &target, const Limits &limits) {
  const bool isRecorded = isStoredHere();
  if (!isRecorded) {
    if (!mayStore_ || position() < storedAt_ + options_.keyframeEvery) return;
    if (!areExtraVerified_ && !(limits.mayTry && hasHashUpTo(limits.until))) return;
  }
  const Keyframe *last = keyframes_.lastUpTo(position(), [](const Keyframe &) { return true; }).get();
  if (last != nullptr && last->at == replay_.position()) return;
  auto state = stateBytes(target.session, target.simulation.object(), recording().start.simulator);
  // A state that cannot be stored, such as one with a renewed reference, is tried again at the next step.
  if (!state) return;
  storedAt_ = position();
  const std::size_t changes = persistent_[replay_.position().next];
  if (!source_ || sourceChanges_ != changes) {
    source_ = std::make_shared<const SimulationSource>(target.changes->source());
    sourceChanges_ = changes;
  }
  auto keyframe = std::make_shared<Keyframe>();
  keyframe->at = replay_.position();
  keyframe->state = std::move(*state);
  keyframe->source = source_;
  keyframe->isExtra = !isRecorded;
  keyframes_.add(std::move(keyframe));
  hasStoredSinceHash_ = hasStoredSinceHash_ || !isRecorded;
}

/// The hashes among the events that were just repeated.
void Timeline::onHashes(std::size_t firstEvent, bool areEqual) {
  const auto &events = recording().events;
  for (std::size_t i = firstEvent; i < replay_.position().next; ++i) {
    const RecordedHash *hash = hashOf(events[i]);
    if (hash == nullptr) continue;
    const bool isMoving = lastHash_ && *lastHash_ != hash->hash;
    lastHash_ = hash->hash;
    if (!areEqual || position() == 0) continue;
    keyframes_.verify(origin_->at.made, position() - 1);
    // At rest, solvers that begin anew find the same.
    if (hasStoredSinceHash_ && isMoving) areExtraVerified_ = true;
    hasStoredSinceHash_ = false;
  }
}

/// The pass is wrong. Removes what may be the reason; false: there is nothing.
bool Timeline::discardSuspectKeyframes() {
  if (hasStoredSinceHash_) {
    mayStore_ = areExtraVerified_ = false;
    keyframes_.removeIf([](const Keyframe &one) { return one.isExtra && !one.isVerified; });
  } else if (origin_ != start_) {
    keyframes_.removeIf([&](const Keyframe &one) { return one.at.made >= origin_->at.made; });
  } else if (isOriginRestored_) {
    mayRestoreStart_ = false;
  } else {
    return false;
  }
  origin_.reset();
  return true;
}

/// False: a keyframe may be the reason.
bool Timeline::acceptDifference() {
  const std::uint64_t at = position();
  if (differsFrom_ && at >= *differsFrom_) return true;
  if (discardSuspectKeyframes()) return false;
  differsFrom_ = at;
  difference_ = fmt::format("differs from the recording at step {}", replay_.nextStep());
  return true;
}

Expected<Timeline::Applied> Timeline::applyDue(const Target &target) {
  for (;;) {
    const std::size_t first = replay_.position().next;
    const auto applied =
        replay_.applyDueEvents(target.session, target.simulation.object(), target.simulation.table(), target.changes);
    if (!applied) {
      if (discardSuspectKeyframes()) return Applied::retry;
      return tl::unexpected(applied.error());
    }
    onHashes(first, true);
    if (replay_.difference().empty()) return Applied::done;
    const std::string difference = replay_.difference();
    if (!acceptDifference()) return Applied::retry;
    const std::size_t behind = replay_.position().next;
    replay_.passDifference();
    onHashes(behind, false);
  }
}

/// Returns the simulated time.
Expected<double> Timeline::step(const Target &target) {
  Session &session = target.session;
  scene::Simulation &simulation = target.simulation;
  c3de_object *simulator = simulation.object();
  const c3de_simulator_v1 *table = simulation.table();
  const auto before = simulatorStatus(table, simulator);
  if (!before) return tl::unexpected(before.error());
  if (const auto ready = simulation.beginStep(); !ready) return tl::unexpected(ready.error());
  const c3de_status code = callPluginFunction(session.plugins().ownerOf(simulator), "a step of the simulation",
                                              CallKind::step, [&] { return table->step(simulator); });
  if (code < 0) {
    const std::string reason = session.plugins().takeError();
    return fail(
        code == C3DE_E_CANCELLED ? ErrorCode::cancelled : ErrorCode::diverged,
        fmt::format("step {} failed: {}", before->steps + 1, reason.empty() ? fmt::format("status {}", code) : reason));
  }
  simulation.endStep();
  const auto after = simulatorStatus(table, simulator);
  if (!after) return tl::unexpected(after.error());
  if (after->steps == before->steps)
    return fail(ErrorCode::state,
                fmt::format("the simulation ends at step {}, and the recording has more", after->steps));
  replay_.countStep();
  return std::max(after->time_s - before->time_s, 0.0);
}

Expected<Timeline::Advanced> Timeline::advance(const Target &target, const Limits &limits) {
  Advanced advanced;
  const auto ends = [&](Outcome outcome) {
    advanced.outcome = outcome;
    return advanced;
  };
  if (!origin_) return ends(Outcome::retry);
  for (;;) {
    const auto applied = applyDue(target);
    if (!applied) return tl::unexpected(applied.error());
    if (*applied == Applied::retry) return ends(Outcome::retry);
    storeIfDue(target, limits);
    if (position() >= limits.until || isAtEnd()) return ends(Outcome::reached);
    if ((limits.isStopped && limits.isStopped()) || std::chrono::steady_clock::now() >= limits.deadline ||
        advanced.simulated_s >= limits.simulated_s)
      return ends(Outcome::paused);
    const auto passed_s = step(target);
    if (!passed_s && passed_s.error().code == ErrorCode::cancelled) return ends(Outcome::paused);
    if (!passed_s) {
      if (discardSuspectKeyframes()) return ends(Outcome::retry);
      return tl::unexpected(passed_s.error());
    }
    // Load steps take no time: one at once, where the pace is limited.
    advanced.simulated_s += *passed_s > 0.0 || !std::isfinite(limits.simulated_s) ? *passed_s : limits.simulated_s;
  }
}

}  // namespace c3de::session
