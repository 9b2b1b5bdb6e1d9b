// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "c3de/session/coverage.h"
#include "c3de/session/tissue_places.h"

namespace c3de::session {

/// Where the wall time goes between the files of a scene and its bodies, s; sums over bodies.
struct Preparation {
  double reading_s = 0.0;   ///< meshes, images and label maps
  double masks_s = 0.0;     ///< labels and thresholds, mended
  double surfaces_s = 0.0;  ///< of masks
  double fills_s = 0.0;     ///< how much of every voxel is inside
  double bodies_s = 0.0;    ///< sampling and all that the simulator builds

  Preparation &operator+=(const Preparation &other) {
    reading_s += other.reading_s;
    masks_s += other.masks_s;
    surfaces_s += other.surfaces_s;
    fills_s += other.fills_s;
    bodies_s += other.bodies_s;
    return *this;
  }
};

/// What there is to say about the bodies of a scene when they are made.
struct Prepared {
  Preparation took;
  std::vector<Coverage> coverage;     ///< of the bodies that were made from images, in their order
  std::vector<TissuePlaces> tissues;  ///< of the bodies of many tissues, in their order
  std::vector<std::string> notices;   ///< BodySources::said(): of files, and what images contradict
};

/// Adds the wall time of its life to a number.
class TimeSpent {
 public:
  explicit TimeSpent(double &seconds) : seconds_(seconds) {}
  TimeSpent(const TimeSpent &) = delete;
  TimeSpent &operator=(const TimeSpent &) = delete;
  ~TimeSpent() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

 private:
  double &seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace c3de::session
