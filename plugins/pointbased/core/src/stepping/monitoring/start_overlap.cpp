// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/start_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/contact_search.h"

namespace pointbased::detail {
namespace {

// Spacings: an obstacle counts as wrapped if it reaches into a body by this much more than the body's skin into the
// obstacle.
constexpr double kMinWrapping = 0.1;
// Spacings: contact separates obstacles that are wrapped less deeply.
constexpr double kMinEnclosed = 0.25;
// Directions of depenetration count as coherent if their mean is at least this long.
constexpr double kMinCoherence = 0.3;
// Fraction of the smallest extent of the body: deeper points are not moved out.
constexpr double kDeepestOfBody = 1.0 / 3.0;
// Cosine of the angle between the direction to the nearest surface and the inward normal: below it the directions
// disagree.
constexpr double kMinInwardCosine = 0.5;
constexpr double kTiny = 1e-6;  // spacings

std::vector<SurfacePoint> queryClosest(const Obstacle &obstacle, const RigidMotion &motion, std::span<const Vec3> world,
                                       const ParallelFor &parallelFor) {
  std::vector<Vec3> at(world.begin(), world.end());
  for (Vec3 &x : at) x = toRestFrame(motion, x);
  const std::vector<double> ranges(at.size(), std::numeric_limits<double>::infinity());
  std::vector<SurfacePoint> found(at.size());
  parallelFor(at.size(), 64, [&](std::size_t begin, std::size_t end) {
    obstacle.closest(std::span<const Vec3>(at).subspan(begin, end - begin),
                     std::span<const double>(ranges).subspan(begin, end - begin),
                     std::span<SurfacePoint>(found).subspan(begin, end - begin));
  });
  return found;
}

std::vector<Vec3> positionsOf(const Body &body) {
  const RestState &rest = body.rest();
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    positions.emplace_back(rest.origin + rest.positions[i] + body.state().displacements[i]);
  return positions;
}

}  // namespace

ObstacleOverlap overlapWith(const Obstacle &obstacle, const RigidMotion &motion, const Body &body,
                            const std::function<MovingSkin *()> &skinOf, const ParallelFor &parallelFor) {
  ObstacleOverlap out;
  const RestState &rest = body.rest();
  if (!obstacle.closest || rest.contact.count() == 0) return out;
  std::vector<Vec3> x(rest.contact.count()), N(x.size());
  updateSurfels(rest.contact.binding, rest.contact.normals, rest.positions, body.state().displacements, x, N,
                parallelFor);
  SkinBox box;
  for (Vec3 &one : x) box.add(one += rest.origin);
  const Vec3 middle = 0.5 * (box.low + box.high);
  const double h = rest.spacing;
  const SurfacePoint atCentre = queryClosest(obstacle, motion, std::span(&middle, 1), parallelFor).front();
  if (!(atCentre.distance < 0.5 * (box.high - box.low).norm() + h)) return out;

  const std::vector<SurfacePoint> ofSkin = queryClosest(obstacle, motion, x, parallelFor);
  double ofPoints = 0.0, ofObstacle = 0.0;
  for (std::size_t p = 0; p < x.size(); ++p) ofPoints = std::max(ofPoints, -ofSkin[p].distance);
  out.depth = ofPoints;
  MovingSkin *skin = skinOf();
  if (!skin) return out;

  // Points of the obstacle's surface nearest to the phyxels of the body.
  const std::vector<Vec3> phyxels = positionsOf(body);
  const std::vector<SurfacePoint> closest = queryClosest(obstacle, motion, phyxels, parallelFor);
  Vec3 deepest = Vec3::Zero();
  for (std::size_t i = 0; i < phyxels.size(); ++i) {
    if (!std::isfinite(closest[i].distance)) continue;
    const Vec3 position = phyxels[i] - closest[i].distance * (motion.rotation * closest[i].normal);
    if (box.squaredDistance(position) > 0.0) continue;
    const double depth = -skin->signedDistance(position);
    if (!(depth > ofObstacle)) continue;
    ofObstacle = depth;
    deepest = position;
    out.phyxel = static_cast<Index>(i);
  }
  out.depth = std::max(ofPoints, ofObstacle);
  const bool isWrapped = ofObstacle > ofPoints + kMinWrapping * h;

  // If the nearest surface is the back of the obstacle, tissue would close around the obstacle.
  const double farthest = (box.high - box.low).norm();
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (std::size_t p = 0; p < x.size(); ++p) {
    if (!(ofSkin[p].distance < -kTiny * h)) continue;
    Vec3 direction = motion.rotation * ofSkin[p].normal;
    if (obstacle.crossing && !(direction.dot(-N[p]) > kMinInwardCosine)) {
      Vec3 normal;
      const double part =
          obstacle.crossing(toRestFrame(motion, x[p]), toRestFrame(motion, Vec3(x[p] - farthest * N[p])), normal);
      const Vec3 position = x[p] - (part * farthest + 0.01 * h) * N[p];
      if (part >= 0.0 && skin->signedDistance(position) < 0.0) {
        direction = -N[p];
        out.redirected.push_back({static_cast<Index>(p), toRestFrame(motion, position)});
      }
    }
    sum += rest.contact.areas[p] * direction;
    area += rest.contact.areas[p];
  }
  if (!isWrapped || !(ofObstacle > kMinEnclosed * h)) return out;
  out.isEnclosed =
      !(sum.norm() > kMinCoherence * area) || ofObstacle > kDeepestOfBody * (box.high - box.low).minCoeff();
  if (out.isEnclosed) out.escape = skin->nearestPoint(deepest) - deepest;
  return out;
}

SkinBox boundsOf(const Body &body) {
  SkinBox box;
  for (const Vec3 &position : positionsOf(body)) box.add(position);
  return box;
}

BodyOverlap overlapBetween(const Body &first, MovingSkin &firstSkin, const Body &second, MovingSkin &secondSkin) {
  BodyOverlap out;
  const auto addOverlap = [&](const Body &body, MovingSkin &other) {
    const std::vector<Vec3> positions = positionsOf(body);
    double inside = 0.0, all = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double mass = body.masses()[i];
      all += mass;
      if (other.tree().bounds().squaredDistance(positions[i]) > 0.0) continue;
      const double depth = -other.signedDistance(positions[i]);
      // Phyxels on the border of a body of the same shape count as inside of it.
      if (!(depth > -kTiny * body.rest().spacing)) continue;
      inside += mass;
      out.depth = std::max(out.depth, depth);
    }
    if (all > 0.0) out.part = std::max(out.part, inside / all);
  };
  addOverlap(first, secondSkin);
  addOverlap(second, firstSkin);
  return out;
}

}  // namespace pointbased::detail
