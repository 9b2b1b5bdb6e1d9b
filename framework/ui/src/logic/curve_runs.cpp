// SPDX-License-Identifier: Apache-2.0
#include "logic/curve_runs.h"

#include <cmath>
#include <cstddef>

namespace c3de::ui {
namespace {

constexpr float kShortest = 0.5f, kCosineOfCorner = 0.5f;

float distance(const CurvePoint &a, const CurvePoint &b) { return std::hypot(b.x - a.x, b.y - a.y); }

bool isCorner(const CurvePoint &a, const CurvePoint &b, const CurvePoint &c) {
  const float dot = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
  return dot < kCosineOfCorner * distance(a, b) * distance(b, c);
}

}  // namespace

std::vector<CurveRun> curveRuns(const std::vector<CurvePoint> &curve, bool isClosed) {
  if (curve.empty()) return {};
  std::vector<CurvePoint> points;
  points.reserve(curve.size());
  for (const CurvePoint &p : curve)
    if (points.empty() || distance(points.back(), p) >= kShortest) points.push_back(p);
  while (isClosed && points.size() > 1 && distance(points.back(), points.front()) < kShortest) points.pop_back();
  if (points.size() == 1) return {{{points[0], {points[0].x + kShortest, points[0].y}}, false}};
  if (points.size() == 2) return {{points, false}};

  const std::size_t n = points.size();
  std::vector<std::size_t> corners;
  for (std::size_t i = isClosed ? 0 : 1; i < (isClosed ? n : n - 1); ++i)
    if (isCorner(points[(i + n - 1) % n], points[i], points[(i + 1) % n])) corners.push_back(i);
  if (corners.empty()) return {{std::move(points), isClosed}};

  std::vector<CurveRun> runs;
  const auto add = [&](std::size_t from, std::size_t to) {
    CurveRun run;
    for (std::size_t i = from; i <= to; ++i) run.points.push_back(points[i % n]);
    runs.push_back(std::move(run));
  };
  if (!isClosed) {
    corners.insert(corners.begin(), 0);
    corners.push_back(n - 1);
  } else {
    corners.push_back(corners.front() + n);
  }
  for (std::size_t c = 0; c + 1 < corners.size(); ++c) add(corners[c], corners[c + 1]);
  return runs;
}

}  // namespace c3de::ui
