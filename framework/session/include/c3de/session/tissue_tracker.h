// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "c3de/scene/simulation.h"
#include "c3de/session/tissue_motion.h"
#include "c3de/session/tissue_surfaces.h"

namespace c3de::session {

/// Displacements of the labels of bodies of many tissues in a running simulation, and positions of tissue surfaces, for
/// display. The simulator is read between two steps; labels and surfaces are tracked in a separate thread.
class TissueTracker {
 public:
  /// @param renewed  called on that thread when there are new values
  explicit TissueTracker(std::function<void()> renewed = {});
  ~TissueTracker();
  TissueTracker(const TissueTracker &) = delete;
  TissueTracker &operator=(const TissueTracker &) = delete;

  /// Starts with the present simulation; empty: it has no such bodies. Any thread.
  void begin(std::vector<TissueVoxels> bodies);
  /// Labels are tracked only while they are displayed. Any thread.
  void want(bool wanted);
  [[nodiscard]] bool wanted() const { return wanted_; }
  /// The displayed surfaces of the present simulation; null: none. Any thread.
  void follow(std::shared_ptr<const std::vector<TissueSurface>> surfaces);
  /// Call on the simulation's thread, after a snapshot. During playback labels are read at most twice a second,
  /// surfaces ten times, using at most a twentieth of the time. Nothing is read while tracking is in progress, nor for
  /// as long after it as it lasted.
  /// @param u             displacement of this snapshot, if another client has requested it
  /// @param isProvidedLater  one of the next snapshots will bring such a displacement: no separate one is requested
  void onPublished(const scene::Simulation &simulation, const std::shared_ptr<const imaging::DisplacementGrid> &u = {},
                   bool isProvidedLater = false);
  /// Null: none yet. Any thread.
  [[nodiscard]] std::shared_ptr<const std::vector<TissueMotion>> newest() const;
  /// Positions of the surfaces; null: not known yet. Any thread.
  [[nodiscard]] std::shared_ptr<const SurfacePositions> places() const;
  /// The bodies of the present simulation. Any thread.
  [[nodiscard]] std::shared_ptr<const std::vector<TissueVoxels>> bodies() const;
  /// Whether a snapshot was skipped and could be read now; checked by a caller that sees the simulation paused.
  [[nodiscard]] bool isBehind() const { return (wanted_ || hasSurfaces_) && behind_ && !isFollowing_; }
  /// Wall time of the last read on the simulation's thread, and of the tracking after it, ms. Any thread.
  [[nodiscard]] double reading_ms() const { return reading_ms_; }
  [[nodiscard]] double following_ms() const { return following_ms_; }

 private:
  void work();

  std::function<void()> renewed_;
  std::atomic<bool> wanted_ = false, hasSurfaces_ = false, behind_ = false, isFollowing_ = false, ends_ = false;
  std::atomic<double> reading_ms_ = 0.0, following_ms_ = 0.0;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t serial_ = 0;  ///< of the simulation
  std::shared_ptr<const std::vector<TissueVoxels>> bodies_;
  std::shared_ptr<const std::vector<TissueMotion>> newest_;
  std::shared_ptr<const std::vector<TissueSurface>> surfaces_;
  std::shared_ptr<const SurfacePositions> places_;
  std::unique_ptr<TissueSnapshot> read_;  ///< waiting to be tracked
  std::uint64_t readSerial_ = 0;
  bool readWhilePlaying_ = false;
  std::chrono::steady_clock::time_point lastRead_{}, lastFollowed_{}, lastLabels_{};
  std::thread thread_;
};

}  // namespace c3de::session
