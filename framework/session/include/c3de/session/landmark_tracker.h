// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/scene/simulation.h"
#include "c3de/session/change_log.h"
#include "c3de/session/measurements.h"

namespace c3de::session {

/// Present positions of landmarks in a running simulation, read from the simulator after each snapshot.
class LandmarkTracker {
 public:
  struct Positions {
    double time_s = 0.0;
    std::vector<Landmark> landmarks;  ///< with the bodies in which they are
    std::vector<Vec3> at_mm;          ///< in their order
    std::string problem;              ///< why they cannot be followed, and are shown at rest; empty: they are followed
  };
  /// @param takeError  returns the text of the last failed call on the simulation's thread; may be empty
  explicit LandmarkTracker(std::function<std::string()> takeError = {}) : takeError_(std::move(takeError)) {}

  /// Landmarks to follow, instead of those of before. Any thread.
  /// @param scene    from which the bodies were built; null: none
  /// @param changes  of the simulator, which is read without a recorded change; null: nothing is read
  void follow(std::vector<Landmark> landmarks, std::shared_ptr<const scene::SceneFile> scene,
              const std::shared_ptr<ChangeLog> &changes);
  /// Call on the simulation's thread, after a snapshot. During playback it runs at most 20 times a second and uses at
  /// most a tenth of the time.
  void onPublished(const scene::Simulation &simulation);
  /// Null: none yet. Any thread.
  [[nodiscard]] std::shared_ptr<const Positions> newest() const;
  /// Whether the last snapshot was skipped, or the landmarks are new; checked by a caller that sees the simulation
  /// paused.
  [[nodiscard]] bool isBehind() const { return behind_; }

 private:
  [[nodiscard]] Positions read(const scene::Simulation &simulation);

  std::function<std::string()> takeError_;
  std::atomic<bool> behind_ = false;
  mutable std::mutex mutex_;
  std::vector<Landmark> wanted_;
  std::shared_ptr<const scene::SceneFile> scene_;
  std::weak_ptr<ChangeLog> changes_;  ///< the tracker may outlive session and simulator
  std::uint64_t serial_ = 0;
  std::shared_ptr<const Positions> newest_;
  // Used by the simulation's thread, and by both threads while one simulation replaces another:
  std::mutex readingMutex_;
  std::vector<Landmark> followed_;
  std::shared_ptr<const scene::SceneFile> followedScene_;
  std::string problem_;
  std::uint64_t followedSerial_ = 0;
  std::chrono::steady_clock::time_point last_{};
  std::chrono::steady_clock::duration took_{};
};

}  // namespace c3de::session
