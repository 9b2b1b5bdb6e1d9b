// SPDX-License-Identifier: Apache-2.0
#include "c3de/tracking/tracked_tool.h"

#include <algorithm>
#include <utility>

namespace c3de::tracking {

bool ToolPoints::add(const Vec3 &at_mm) {
  if (std::none_of(points_.begin(), points_.end(),
                   [&](const Vec3 &point) { return norm(at_mm - point) < kSpacing_mm; }))
    points_.push_back(at_mm);
  return points_.size() >= frameSize_;
}

std::vector<Vec3> ToolPoints::take() { return std::exchange(points_, {}); }

}  // namespace c3de::tracking
