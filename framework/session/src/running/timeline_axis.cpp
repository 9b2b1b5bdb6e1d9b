// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/timeline_axis.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "c3de/abi/iface/changes.h"

namespace c3de::session {
namespace {

/// After it, steps count from 0.
bool isReset(const RecordedEvent &event) {
  if (const auto *change = std::get_if<SimulationChange>(&event)) return (change->flags & C3DE_SIM_CHANGE_RESETS) != 0;
  return std::holds_alternative<RecordedReset>(event);
}

/// After it, the steps are not those before; how many is not recorded.
bool setsSteps(const RecordedEvent &event) {
  return std::holds_alternative<RecordedState>(event) || std::holds_alternative<RecordedScene>(event);
}

/// What the simulator does for undo and for saving is no change of the user.
bool isShown(const SimulationChange &change) {
  const std::string_view id = change.id;
  return !change.text.empty() && !id.starts_with("checkpoint.") && id != "state.store";
}

}  // namespace

TimelineAxis::TimelineAxis(const Recording &recording) {
  placeEvents(recording);
  addTimes(recording);
  addMarks(recording);
}

/// A position is the steps of an event plus what was made before the last reset or loaded state. Only a hash states
/// both, so the offset behind a loaded state is that of the next hash.
void TimelineAxis::placeEvents(const Recording &recording) {
  const auto &events = recording.events;
  events_.assign(events.size(), 0);
  std::optional<std::int64_t> offset = -static_cast<std::int64_t>(recording.start.session.steps);
  std::uint64_t last = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto steps = static_cast<std::int64_t>(stepsOf(events[i]));
    if (!offset) {
      for (std::size_t j = i; j < events.size() && !offset; ++j) {
        if (const RecordedHash *hash = hashOf(events[j]))
          offset = static_cast<std::int64_t>(hash->made) - static_cast<std::int64_t>(hash->steps);
        else if (isReset(events[j]) || setsSteps(events[j]))
          break;
      }
      if (!offset) offset = static_cast<std::int64_t>(last) - steps;
    }
    if (const RecordedHash *hash = hashOf(events[i]))
      last = hash->made;
    else
      last = static_cast<std::uint64_t>(std::max(*offset + steps, static_cast<std::int64_t>(last)));
    events_[i] = last;
    if (isReset(events[i])) offset = static_cast<std::int64_t>(last);
    if (setsSteps(events[i])) offset.reset();
  }
  length_ = last;
}

void TimelineAxis::addTimes(const Recording &recording) {
  times_.push_back({0, 0.0});
  double before_s = recording.start.session.time_s, step_s = 0.0;
  std::uint64_t resetAt = 0;
  bool isAfterReset = false;
  for (std::size_t i = 0; i < recording.events.size(); ++i) {
    const RecordedEvent &event = recording.events[i];
    if (isReset(event) || setsSteps(event)) {
      // The time up to it is not recorded: its steps take as long as those before.
      isAfterReset = true;
      if (events_[i] > times_.back().made)
        times_.push_back(
            {events_[i], times_.back().time_s + step_s * static_cast<double>(events_[i] - times_.back().made)});
      resetAt = events_[i];
      continue;
    }
    const RecordedHash *hash = hashOf(event);
    if (hash == nullptr) continue;
    const std::uint64_t steps = hash->made - std::min(hash->made, times_.back().made);
    if (steps > 0) {
      const double perStep_s = hash->steps > 0 ? hash->time_s / static_cast<double>(hash->steps) : 0.0;
      const double passed_s =
          isAfterReset ? perStep_s * static_cast<double>(hash->made - resetAt) : hash->time_s - before_s;
      times_.push_back({hash->made, times_.back().time_s + std::max(passed_s, 0.0)});
      step_s = std::max(passed_s, 0.0) / static_cast<double>(steps);
    }
    before_s = hash->time_s;
    isAfterReset = false;
  }
  if (times_.back().made < length_)
    times_.push_back({length_, times_.back().time_s + step_s * static_cast<double>(length_ - times_.back().made)});
}

void TimelineAxis::addMarks(const Recording &recording) {
  const auto add = [this](std::uint64_t made, const std::string &text) {
    if (marks_.empty() || marks_.back().text != text) marks_.push_back({made, text});
  };
  for (std::size_t i = 0; i < recording.events.size(); ++i) {
    const RecordedEvent &event = recording.events[i];
    if (const auto *change = std::get_if<SimulationChange>(&event)) {
      if (isShown(*change)) add(events_[i], change->text);
    } else if (std::holds_alternative<RecordedReset>(event)) {
      marks_.push_back({events_[i], "reset"});
    } else if (std::holds_alternative<RecordedState>(event)) {
      marks_.push_back({events_[i], "load state"});
    } else if (std::holds_alternative<RecordedScene>(event)) {
      marks_.push_back({events_[i], "add bodies"});
    }
  }
}

double TimelineAxis::timeAt_s(std::uint64_t made) const {
  const auto above =
      std::lower_bound(times_.begin(), times_.end(), made, [](const Point &p, std::uint64_t m) { return p.made < m; });
  if (above == times_.end()) return times_.back().time_s;
  if (above == times_.begin()) return above->time_s;
  const Point &low = *(above - 1);
  const double share = static_cast<double>(made - low.made) / static_cast<double>(above->made - low.made);
  return low.time_s + share * (above->time_s - low.time_s);
}

}  // namespace c3de::session
