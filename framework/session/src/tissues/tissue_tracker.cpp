// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_tracker.h"

#include <algorithm>
#include <utility>

namespace c3de::session {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLabels_ms = 500.0, kSurfaces_ms = 100.0, kRestPerReading = 20.0;

double since_ms(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

}  // namespace

TissueTracker::TissueTracker(std::function<void()> renewed) : renewed_(std::move(renewed)) {
  thread_ = std::thread([this] { work(); });
}

TissueTracker::~TissueTracker() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void TissueTracker::begin(std::vector<TissueVoxels> bodies) {
  const std::lock_guard lock(mutex_);
  ++serial_;
  bodies_ = bodies.empty() ? nullptr : std::make_shared<const std::vector<TissueVoxels>>(std::move(bodies));
  newest_.reset();
  surfaces_.reset();
  hasSurfaces_ = false;
  places_.reset();
  read_.reset();
  behind_ = bodies_ != nullptr;
}

void TissueTracker::want(bool wanted) {
  if (wanted_.exchange(wanted) || !wanted) return;
  // A snapshot that was read for surfaces alone contains no result for labels.
  const std::lock_guard lock(mutex_);
  behind_ = bodies_ != nullptr;
}

void TissueTracker::follow(std::shared_ptr<const std::vector<TissueSurface>> surfaces) {
  const std::lock_guard lock(mutex_);
  if (surfaces == surfaces_) return;
  surfaces_ = std::move(surfaces);
  hasSurfaces_ = surfaces_ != nullptr;
  places_.reset();
  behind_ = bodies_ != nullptr;
}

std::shared_ptr<const SurfacePositions> TissueTracker::places() const {
  const std::lock_guard lock(mutex_);
  return places_;
}

std::shared_ptr<const std::vector<TissueMotion>> TissueTracker::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

std::shared_ptr<const std::vector<TissueVoxels>> TissueTracker::bodies() const {
  const std::lock_guard lock(mutex_);
  return bodies_;
}

void TissueTracker::onPublished(const scene::Simulation &simulation,
                                const std::shared_ptr<const imaging::DisplacementGrid> &u, bool isProvidedLater) {
  std::uint64_t serial = 0;
  bool isPlaying = false;
  {
    const std::lock_guard lock(mutex_);
    if (!bodies_) return;
    behind_ = true;  // until it is read
    if ((!wanted_ && !hasSurfaces_) || isFollowing_) return;
    isPlaying = simulation.state().mode == C3DE_SIM_PLAYING;
    const double least = hasSurfaces_ ? kSurfaces_ms : kLabels_ms;
    if (isPlaying && ((isProvidedLater && !u) || since_ms(lastRead_) < std::max(least, kRestPerReading * reading_ms_) ||
                      since_ms(lastFollowed_) < following_ms_))
      return;
    serial = serial_;
  }
  const auto from = Clock::now();
  const auto readSeparately = [&] { return readTissues(simulation.table(), simulation.object(), TissueDetail::live); };
  auto snapshot = u ? readTissues(simulation.object(), u) : readSeparately();
  if (!snapshot && u) snapshot = readSeparately();
  {
    const std::lock_guard lock(mutex_);
    lastRead_ = Clock::now();
    reading_ms_ = since_ms(from);
    behind_ = false;
    if (!snapshot || serial != serial_) return;
    read_ = std::make_unique<TissueSnapshot>(std::move(*snapshot));
    readSerial_ = serial;
    readWhilePlaying_ = isPlaying;
    isFollowing_ = true;
  }
  changed_.notify_all();
}

void TissueTracker::work() {
  std::unique_lock lock(mutex_);
  while (!ends_) {
    changed_.wait(lock, [&] { return ends_ || read_ || isFollowing_; });
    const std::unique_ptr<TissueSnapshot> snapshot = std::move(read_);
    const std::uint64_t serial = readSerial_;
    const std::shared_ptr<const std::vector<TissueVoxels>> bodies = bodies_;
    const std::shared_ptr<const std::vector<TissueSurface>> surfaces = surfaces_;
    const std::shared_ptr<const SurfacePositions> before = places_;
    const bool wantsLabels = wanted_ && !(readWhilePlaying_ && since_ms(lastLabels_) < kLabels_ms);
    if (!snapshot || !bodies || ends_) {
      isFollowing_ = false;
      continue;
    }
    lock.unlock();
    const auto from = Clock::now();
    const auto goesOn = [this] { return !ends_; };
    auto places = surfaces ? followSurfaces(*snapshot, surfaces, before.get(), goesOn) : SurfacePositions{};
    auto motions = wantsLabels ? followTissues(*snapshot, *bodies, goesOn) : std::vector<TissueMotion>{};
    lock.lock();
    following_ms_ = since_ms(from);
    lastFollowed_ = Clock::now();
    isFollowing_ = false;
    if (serial != serial_) continue;
    if (places && surfaces && surfaces == surfaces_)
      places_ = std::make_shared<const SurfacePositions>(std::move(*places));
    if (motions && wantsLabels) {
      newest_ = std::make_shared<const std::vector<TissueMotion>>(std::move(*motions));
      lastLabels_ = lastFollowed_;
    }
    lock.unlock();
    if (renewed_) renewed_();
    lock.lock();
  }
}

}  // namespace c3de::session
