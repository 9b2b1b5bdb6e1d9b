// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::tracking {

/// A tracked tool, such as a stylus, whose tip is moved along a surface.
struct TrackedTool {
  std::string device;           ///< name of its messages, which contain its first 20 bytes
  std::size_t frameSize = 200;  ///< points of a frame, > 0
};

/// Collects positions of the tip until they are a frame. A tip at rest adds nothing, because positions near a collected
/// one are skipped.
class ToolPoints {
 public:
  explicit ToolPoints(std::size_t frameSize) : frameSize_(frameSize) {}

  /// True: the frame is complete.
  [[nodiscard]] bool add(const Vec3 &at_mm);
  /// The points collected, mm. The next frame begins.
  [[nodiscard]] std::vector<Vec3> take();
  [[nodiscard]] std::size_t count() const { return points_.size(); }

  static constexpr double kSpacing_mm = 2.0;  ///< least distance between two points of a frame

 private:
  std::size_t frameSize_;
  std::vector<Vec3> points_;
};

}  // namespace c3de::tracking
