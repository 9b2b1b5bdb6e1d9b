// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/skin_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/point_tree.h"
#include "contact/contact_search.h"

namespace pointbased {
namespace {

struct Bounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void add(const Vec3 &x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  [[nodiscard]] bool overlaps(const Bounds &other, double margin) const {
    return ((low - other.high).array() <= margin).all() && ((other.low - high).array() <= margin).all();
  }
  [[nodiscard]] bool contains(const Vec3 &x, double margin) const {
    return ((x - low).array() >= -margin).all() && ((high - x).array() >= -margin).all();
  }
};

// The skin is within the box of the phyxels that carry it, except where it is extrapolated beyond their cells.
Bounds boundsOf(const Body &body) {
  Bounds bounds;
  const RestState &rest = body.rest();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    bounds.add(rest.origin + rest.positions[i] + body.state().displacements[i]);
  return bounds;
}

// The contact points in the box of another body.
struct SkinSample {
  std::vector<Vec3> positions, normals;
  std::vector<double> areas;
};

SkinSample sampleSkin(const Body &body, const Bounds &where, double margin) {
  const RestState &rest = body.rest();
  const ContactPoints &points = rest.contact;
  std::vector<Vec3> x(points.count()), n(points.count());
  updateSurfels(points.binding, points.normals, rest.positions, body.state().displacements, x, n, serialFor());
  SkinSample sample;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const Vec3 at = rest.origin + x[p];
    if (!where.contains(at, margin)) continue;
    sample.positions.push_back(at);
    sample.normals.push_back(n[p]);
    sample.areas.push_back(points.areas[p]);
  }
  return sample;
}

// Points of one side behind the nearest points of the other: largest depth, and sum of area times depth.
Overlap measureOverlap(const SkinSample &points, const SkinSample &of, double reach) {
  Overlap out;
  if (points.positions.empty() || of.positions.empty()) return out;
  const PointTree tree(of.positions);
  for (std::size_t p = 0; p < points.positions.size(); ++p) {
    Index nearest = 0;
    double squared = 0.0;
    if (tree.nearest(points.positions[p], 1, &nearest, &squared) == 0) continue;
    const double depth = (of.positions[nearest] - points.positions[p]).dot(of.normals[nearest]);
    // Near the rim of the checked points, the nearest one does not determine inside and outside.
    if (!(depth > 0.0) || squared > 2.0 * (depth * depth + reach * reach)) continue;
    out.depth = std::max(out.depth, depth);
    out.volume += points.areas[p] * depth;
  }
  return out;
}

}  // namespace

double skinDepth(const Body &body, std::span<const Obstacle> obstacles, const WorldBox &box, double time,
                 std::vector<Vec3> &skin, const ParallelFor &parallelFor) {
  if (!box.enabled && obstacles.empty()) return 0.0;
  const RestState &rest = body.rest();
  skin.resize(rest.surfels.count());
  if (skin.empty()) return 0.0;
  updateSurfels(rest.surfels, {}, rest.positions, body.state().displacements, skin, {}, parallelFor);
  double deepest = 0.0;
  for (Vec3 &x : skin) {
    x += rest.origin;
    if (box.enabled) deepest = std::max({deepest, (box.min - x).maxCoeff(), (x - box.max).maxCoeff()});
  }
  if (obstacles.empty()) return std::isfinite(deepest) ? deepest : 0.0;
  const std::vector<double> ranges(skin.size(), std::numeric_limits<double>::infinity());
  std::vector<SurfacePoint> found(skin.size());
  for (const Obstacle &obstacle : obstacles) {
    if (!obstacle.closest) continue;
    std::vector<Vec3> at = skin;
    if (obstacle.motion) {
      const RigidMotion motion = obstacle.motion(time);
      for (Vec3 &x : at) x = detail::toRestFrame(motion, x);
    }
    parallelFor(at.size(), 256, [&](std::size_t begin, std::size_t end) {
      obstacle.closest(std::span<const Vec3>(at).subspan(begin, end - begin),
                       std::span<const double>(ranges).subspan(begin, end - begin),
                       std::span<SurfacePoint>(found).subspan(begin, end - begin));
    });
    for (const SurfacePoint &point : found) deepest = std::max(deepest, -point.distance);
  }
  return std::isfinite(deepest) ? deepest : 0.0;
}

double depthOfPassage(const Body &body, std::span<const Obstacle> obstacles, double time,
                      const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  const std::vector<std::vector<ContactState::LastOutside>> &lastOutside = body.contact.lastOutside;
  const std::size_t count = rest.contact.count();
  double deepest = 0.0;
  std::vector<Vec3> points;
  for (std::size_t o = 0; o < std::min(obstacles.size(), lastOutside.size()); ++o) {
    if (!obstacles[o].crossing || lastOutside[o].size() != count) continue;
    if (points.empty()) {
      points.resize(count);
      updateSurfels(rest.contact.binding, {}, rest.positions, body.state().displacements, points, {}, parallelFor);
    }
    const RigidMotion motion = obstacles[o].motion ? obstacles[o].motion(time) : RigidMotion{};
    for (std::size_t p = 0; p < count; ++p) {
      if (!lastOutside[o][p].isKnown) continue;
      const Vec3 &from = lastOutside[o][p].position, to = detail::toRestFrame(motion, Vec3(rest.origin + points[p]));
      Vec3 normal;
      const double part = from == to ? -1.0 : obstacles[o].crossing(from, to, normal);
      if (part >= 0.0) deepest = std::max(deepest, std::abs(normal.dot((1.0 - part) * (to - from))));
    }
  }
  return std::isfinite(deepest) ? deepest : 0.0;
}

Overlap overlapOf(const Body &a, const Body &b) {
  if (a.rest().contact.count() == 0 || b.rest().contact.count() == 0) return {};
  const double reach = std::max(a.rest().spacing, b.rest().spacing);
  const Bounds boundsA = boundsOf(a), boundsB = boundsOf(b);
  if (!boundsA.overlaps(boundsB, 0.0)) return {};
  const SkinSample sampleA = sampleSkin(a, boundsB, reach), sampleB = sampleSkin(b, boundsA, reach);
  const Overlap inB = measureOverlap(sampleA, sampleB, reach), inA = measureOverlap(sampleB, sampleA, reach);
  return {std::max(inA.depth, inB.depth), 0.5 * (inA.volume + inB.volume),
          a.rest().contact.count() + b.rest().contact.count()};
}

}  // namespace pointbased
