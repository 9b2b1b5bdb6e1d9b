// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/warp_grid.h"

#include <algorithm>
#include <cmath>

namespace c3de::imaging {
namespace {

constexpr double kFinestStep = 0.5;  // spacings
constexpr double kRoom = 0.15;       // margin for motion on each side, relative to the size of the bodies
// Rebuild when the grid could be finer by this factor: beyond what the margin alone changes.
constexpr double kMuchFiner = 0.6;

}  // namespace

void WorldBox::add(const Vec3 &point) {
  if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2])) return;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], point[a]);
    high[a] = std::max(high[a], point[a]);
  }
}

void WorldBox::cutTo(const WorldBox &other) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(low[a], other.low[a]);
    high[a] = std::min(high[a], other.high[a]);
  }
}

WorldBox WorldBox::grown(double by_mm) const {
  WorldBox box = *this;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] -= by_mm;
    box.high[a] += by_mm;
  }
  return box;
}

bool WorldBox::holds(const WorldBox &other) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (!(low[a] <= other.low[a] && other.high[a] <= high[a])) return false;
  return true;
}

WorldBox boxOf(const VolumeGeometry &geometry) {
  WorldBox box;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (corner >> a & 1u) != 0 ? static_cast<double>(geometry.size[a]) - 0.5 : -0.5;
    box.add(geometry.worldAt(index));
  }
  return box;
}

void FollowingGrid::forget() { *this = FollowingGrid(limits_); }

FollowingGrid::Plan FollowingGrid::plan(const WorldBox &bodies, double spacing_mm, double rim_mm) const {
  Plan plan;
  plan.needed = plan.laid = bodies.grown(rim_mm + spacing_mm);
  const auto cells = static_cast<double>(limits_.mostPoints - 1);
  const double most_mm = cells * limits_.coarsestStep * spacing_mm;
  double longest_mm = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double room = kRoom * (bodies.high[a] - bodies.low[a]);
    double &low = plan.laid.low[a], &high = plan.laid.high[a];
    low -= room;
    high += room;
    if (high - low > most_mm) {
      const double middle = std::clamp((*home_)[a], low + 0.5 * most_mm, high - 0.5 * most_mm);
      low = middle - 0.5 * most_mm;
      high = middle + 0.5 * most_mm;
    }
    longest_mm = std::max(longest_mm, high - low);
  }
  plan.needed.cutTo(plan.laid);
  plan.step_mm = std::max(kFinestStep * spacing_mm, longest_mm / cells);
  return plan;
}

bool FollowingGrid::follow(const WorldBox &bodies, double spacing_mm, double rim_mm) {
  if (bodies.isEmpty() || !std::isfinite(spacing_mm) || !(spacing_mm > 0.0)) {
    const bool was = geometry_.voxelCount() != 0;
    geometry_.size = {0, 0, 0};
    laid_ = {};
    return was;
  }
  if (!home_) home_ = 0.5 * (bodies.low + bodies.high);
  const Plan plan = this->plan(bodies, spacing_mm, rim_mm);
  if (geometry_.voxelCount() != 0 && rim_mm == rim_mm_ && laid_.holds(plan.needed) &&
      plan.step_mm > kMuchFiner * step_mm_)
    return false;
  laid_ = plan.laid;
  rim_mm_ = rim_mm;
  step_mm_ = plan.step_mm;
  geometry_ = {{0, 0, 0}, kIdentity4};
  for (std::size_t a = 0; a < 3; ++a) {
    const double cells = std::ceil((laid_.high[a] - laid_.low[a]) / step_mm_ - 1e-9);
    geometry_.size[a] = static_cast<std::size_t>(std::max(cells, 0.0)) + 1;
    geometry_.indexToWorld[5 * a] = step_mm_;
    geometry_.indexToWorld[12 + a] = laid_.low[a];
  }
  return true;
}

}  // namespace c3de::imaging
