// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "c3de/session/coverage.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// Wall time spent between reading the files of a scene and its finished bodies, s; sums over bodies.
struct Preparation {
  double reading_s = 0.0;   ///< meshes, images and label maps
  double masks_s = 0.0;     ///< labels and thresholds, including mending
  double surfaces_s = 0.0;  ///< of masks
  double fills_s = 0.0;     ///< fraction of every voxel that is inside
  double bodies_s = 0.0;    ///< sampling and all structures that the simulator builds

  Preparation &operator+=(const Preparation &other) {
    reading_s += other.reading_s;
    masks_s += other.masks_s;
    surfaces_s += other.surfaces_s;
    fills_s += other.fills_s;
    bodies_s += other.bodies_s;
    return *this;
  }
};

/// Results to report about the bodies of a scene after they are built.
struct Prepared {
  Preparation took;
  std::vector<Coverage> coverage;     ///< of the bodies built from images, in their order
  std::vector<TissueVoxels> tissues;  ///< of the bodies of many tissues, in their order
  std::vector<std::string> notices;   ///< BodySources::reportedNotices(): about files and label maps
};

/// Adds the wall time of its lifetime to a sum.
class ScopedTimer {
 public:
  explicit ScopedTimer(double &seconds) : seconds_(seconds) {}
  ScopedTimer(const ScopedTimer &) = delete;
  ScopedTimer &operator=(const ScopedTimer &) = delete;
  ~ScopedTimer() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

 private:
  double &seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace c3de::session
