// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace c3de::ui {

struct CurvePoint {
  float x = 0.0f, y = 0.0f;
};

struct CurveRun {
  std::vector<CurvePoint> points;
  bool isClosed = false;
};

/// A curve in pixels as pieces that a thick line can follow. Steps below half a pixel are dropped. Pieces end at
/// corners of more than 60 degrees, where the mitre of a line would be a spike. A curve that shrinks to a point is a
/// run of two.
[[nodiscard]] std::vector<CurveRun> curveRuns(const std::vector<CurvePoint> &curve, bool isClosed);

}  // namespace c3de::ui
