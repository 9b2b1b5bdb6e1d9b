// SPDX-License-Identifier: Apache-2.0
#include "pace.h"

#include <algorithm>
#include <cmath>

namespace c3de::scene {
namespace {

/// Maximum lag behind the wall clock before time is dropped. Long enough to even out one slow step, short enough that
/// no burst is visible afterwards.
constexpr double kMaxLag_s = 0.05;
constexpr double kWindow_s = 1.0;

std::chrono::nanoseconds nanoseconds(double s) {
  // A rate close to zero gives a wait that no clock type can represent. An hour suffices, because the wait is
  // interrupted anyway.
  return std::chrono::nanoseconds(std::llround(std::clamp(s, -3600.0, 3600.0) * 1e9));
}

}  // namespace

Clock::time_point Pace::dueTime(double end_s, double rate, Clock::time_point now) {
  const Clock::time_point due = anchor_ + nanoseconds((end_s - anchorTime_s_) / rate);
  const Clock::time_point latest = now - nanoseconds(kMaxLag_s);
  if (due >= latest) return due;
  anchor_ += latest - due;
  return latest;
}

double Meter::Rates::realTimeFactor(double running_s) const {
  if (!(wall_s > 0.0)) return 0.0;
  const double overdue_s = std::max(0.0, running_s - meanStep_s);
  const double part = std::max(0.0, 1.0 - overdue_s / kWindow_s);  // fraction of the samples within the last second
  return part * simulated_s / (part * wall_s + overdue_s);
}

void Meter::clear() {
  samples_.clear();
  wall_s_ = computing_s_ = simulated_s_ = 0.0;
  running_ = false;
}

void Meter::add(Clock::time_point now, double step_s, double advance_s) {
  // The first step after a pause counts with its own duration, because the wait before it was not playing.
  const double wall_s = running_ ? std::chrono::duration<double>(now - last_).count() : step_s;
  running_ = true;
  last_ = now;
  samples_.push_back({wall_s, step_s, advance_s});
  wall_s_ += wall_s;
  computing_s_ += step_s;
  simulated_s_ += advance_s;
  while (samples_.size() > 1 && wall_s_ - samples_.front().wall_s >= kWindow_s) {
    wall_s_ -= samples_.front().wall_s;
    computing_s_ -= samples_.front().step_s;
    simulated_s_ -= samples_.front().advance_s;
    samples_.pop_front();
  }
}

}  // namespace c3de::scene
