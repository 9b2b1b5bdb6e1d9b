// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/landmark_tracker.h"

#include <algorithm>

#include "c3de/session/simulator_access.h"

namespace c3de::session {

void LandmarkTracker::follow(std::vector<Landmark> landmarks, std::shared_ptr<const scene::SceneFile> scene,
                             const std::shared_ptr<ChangeLog> &changes) {
  const std::lock_guard lock(mutex_);
  wanted_ = std::move(landmarks);
  scene_ = std::move(scene);
  changes_ = changes;
  ++serial_;
  newest_.reset();
  behind_ = !wanted_.empty();
}

std::shared_ptr<const LandmarkTracker::Positions> LandmarkTracker::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

LandmarkTracker::Positions LandmarkTracker::read(const scene::Simulation &simulation) {
  Positions out{simulation.state().time_s, followed_, {}, problem_};
  // The time that belongs to these positions; state() may be that of an earlier snapshot.
  if (const auto status = simulatorStatus(simulation.table(), simulation.object())) out.time_s = status->time_s;
  const auto measured = problem_.empty() ? measure(simulation.object(), {}, followed_, takeError_)
                                         : Expected<Measurements>(fail(ErrorCode::state, problem_));
  if (!measured) out.problem = measured.error().message;
  for (std::size_t i = 0; i < followed_.size(); ++i)
    out.at_mm.push_back(measured ? measured->landmarks[i].position_mm : followed_[i].reference_mm);
  return out;
}

void LandmarkTracker::onPublished(const scene::Simulation &simulation) {
  constexpr auto kShortest = std::chrono::milliseconds(50);
  const std::lock_guard reading(readingMutex_);
  const auto now = std::chrono::steady_clock::now();
  std::uint64_t serial = 0;
  std::shared_ptr<ChangeLog> changes;
  {
    const std::lock_guard lock(mutex_);
    // Another simulation has replaced the one of these landmarks.
    changes = changes_.lock();
    if (wanted_.empty() || !changes || !changes->isOf(simulation.object())) return;
    serial = serial_;
    const bool isPlaying = simulation.state().mode == C3DE_SIM_PLAYING;
    if (isPlaying && serial == followedSerial_ && now - last_ < std::max<decltype(took_)>(kShortest, 10 * took_)) {
      behind_ = true;
      return;
    }
    if (serial != followedSerial_) {
      followed_ = wanted_;
      followedScene_ = scene_;
    }
  }
  const ChangeLog::Unrecorded reads(*changes);
  if (serial != followedSerial_) {
    followedSerial_ = serial;
    problem_.clear();
    if (auto found = findBodies(simulation.object(), followedScene_ ? *followedScene_ : scene::SceneFile(), followed_,
                                takeError_);
        !found)
      problem_ = found.error().message;
  }
  auto positions = std::make_shared<const Positions>(read(simulation));
  last_ = std::chrono::steady_clock::now();
  took_ = last_ - now;
  const std::lock_guard lock(mutex_);
  if (serial != serial_) return;
  newest_ = std::move(positions);
  behind_ = false;
}

}  // namespace c3de::session
