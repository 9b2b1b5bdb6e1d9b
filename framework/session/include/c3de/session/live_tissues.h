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

/// How the labels of bodies of many tissues have moved in a running simulation, and where surfaces of tissues are, for
/// who looks at them. What the simulator says is read between two steps; labels and surfaces are followed in a thread
/// of its own.
class LiveTissues {
 public:
  /// @param renewed  called on that thread when there are new numbers
  explicit LiveTissues(std::function<void()> renewed = {});
  ~LiveTissues();
  LiveTissues(const LiveTissues &) = delete;
  LiveTissues &operator=(const LiveTissues &) = delete;

  /// Of the simulation that goes on from here; empty: it has no such bodies. Any thread.
  void begin(std::vector<TissuePlaces> bodies);
  /// Somebody looks at the labels; else they are not followed. Any thread.
  void want(bool wanted);
  [[nodiscard]] bool wanted() const { return wanted_; }
  /// Surfaces of the present simulation that somebody looks at; null: none. Any thread.
  void follow(std::shared_ptr<const std::vector<TissueSurface>> surfaces);
  /// On the simulation's thread, after a snapshot. While it plays labels at most twice a second, surfaces ten times,
  /// and no more than a twentieth of the time; not while something is still followed, and not for as long after it as
  /// that took.
  /// @param u             of this snapshot, if somebody has asked for it anyway
  /// @param comesWithOthers  such a one comes with one of the next snapshots: one of its own is not asked for
  void onPublished(const scene::Simulation &simulation, const std::shared_ptr<const imaging::DisplacementGrid> &u = {},
                   bool comesWithOthers = false);
  /// Null: none yet. Any thread.
  [[nodiscard]] std::shared_ptr<const std::vector<TissueMotion>> newest() const;
  /// Where the surfaces are; null: not known yet. Any thread.
  [[nodiscard]] std::shared_ptr<const SurfacePlaces> places() const;
  /// Of the present simulation. Any thread.
  [[nodiscard]] std::shared_ptr<const std::vector<TissuePlaces>> bodies() const;
  /// Whether a snapshot went without and could be read now; asked by who sees that the simulation stands.
  [[nodiscard]] bool isBehind() const { return (wanted_ || hasSurfaces_) && behind_ && !isFollowing_; }
  /// Wall time of the last reading on the simulation's thread and of what came after it, ms. Any thread.
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
  std::shared_ptr<const std::vector<TissuePlaces>> bodies_;
  std::shared_ptr<const std::vector<TissueMotion>> newest_;
  std::shared_ptr<const std::vector<TissueSurface>> surfaces_;
  std::shared_ptr<const SurfacePlaces> places_;
  std::unique_ptr<TissueSnapshot> read_;  ///< to be followed
  std::uint64_t readSerial_ = 0;
  bool readWhilePlaying_ = false;
  std::chrono::steady_clock::time_point lastRead_{}, lastFollowed_{}, lastLabels_{};
  std::thread thread_;
};

}  // namespace c3de::session
