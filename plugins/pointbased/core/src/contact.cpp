// SPDX-License-Identifier: Apache-2.0
#include "pointbased/contact.h"

#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

// Part of a penetration that is undone per step, and the fastest speed for it in spacings per second: quick enough that
// a pressed body does not sink, slow enough that it is not thrown.
constexpr double kRecovery = 0.2;
constexpr double kRecoverySpeed = 20.0;

// Stops v·n at `least` and brakes the rest; the impulse per mass is what friction may use.
void constrain(Vec3 &v, const Vec3 &n, double least, double friction) {
  const double normal = v.dot(n);
  const double impulse = least - normal;
  if (impulse <= 0.0) return;
  Vec3 tangential = v - normal * n;
  const double speed = tangential.norm();
  // What only leads out of a penetration must not brake.
  const double grip = friction * std::max(0.0, std::min(impulse, -normal));
  tangential *= speed > grip ? 1.0 - grip / speed : 0.0;
  v = tangential + least * n;
}

double leastNormalSpeed(double gap, double spacing, double dt) {
  if (gap >= 0.0) return -gap / dt;
  return std::min(-kRecovery * gap / dt, kRecoverySpeed * spacing);
}

}  // namespace

void resolveContacts(std::span<const Obstacle> obstacles, const WorldBox &box, std::span<const Vec3> positions,
                     std::span<Vec3> velocities, std::span<const double> radii, double spacing, double dt,
                     ContactMemory &memory, const ParallelFor &parallelFor) {
  const std::size_t n = positions.size();
  memory.active.clear();
  memory.clearance.resize(obstacles.size());

  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const Obstacle &obstacle = obstacles[o];
    std::vector<double> &clearance = memory.clearance[o];
    const bool first = clearance.size() != n;
    if (first) clearance.assign(n, 0.0);

    std::vector<Index> &asking = memory.questions.phyxels;
    asking.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const double way = velocities[i].norm() * dt;
      // NaN asks as well; the guard finds it later.
      if (!first && clearance[i] > way) {
        clearance[i] -= way;
      } else {
        asking.push_back(static_cast<Index>(i));
      }
    }
    if (asking.empty()) continue;

    std::vector<Vec3> &points = memory.questions.points;
    std::vector<double> &ranges = memory.questions.ranges;
    std::vector<SurfacePoint> &found = memory.questions.answers;
    points.resize(asking.size());
    ranges.resize(asking.size());
    found.resize(asking.size());
    for (std::size_t k = 0; k < asking.size(); ++k) {
      const Index i = asking[k];
      points[k] = positions[i];
      // The first time without limit, so that a phyxel that starts deep inside is known to be there.
      ranges[k] = first ? std::numeric_limits<double>::infinity()
                        : radii[i] + std::max(4.0 * spacing, 4.0 * velocities[i].norm() * dt);
    }
    parallelFor(asking.size(), 16, [&](std::size_t begin, std::size_t end) {
      obstacle.closest(std::span<const Vec3>(points).subspan(begin, end - begin),
                       std::span<const double>(ranges).subspan(begin, end - begin),
                       std::span<SurfacePoint>(found).subspan(begin, end - begin));
    });

    for (std::size_t k = 0; k < asking.size(); ++k) {
      const Index i = asking[k];
      Vec3 &v = velocities[i];
      const double way = v.norm() * dt;
      const double gap = std::min(found[k].distance, ranges[k]) - radii[i];
      clearance[i] = std::max(0.0, gap - way);
      if (gap < way && std::isfinite(found[k].distance)) {
        memory.deepestEver = std::max(memory.deepestEver, -found[k].distance);
        const Vec3 before = v;
        constrain(v, found[k].normal, leastNormalSpeed(gap, spacing, dt), obstacle.friction);
        if (v != before || gap <= 1e-3 * spacing) memory.active.push_back({i, found[k].normal, obstacle.friction});
      }
      // A way longer than half a spacing can meet another part of the surface than the closest one.
      if (v.norm() * dt > 0.5 * spacing && obstacle.crossing) {
        Vec3 normal;
        const Vec3 step = v * dt;
        const double t = obstacle.crossing(positions[i], positions[i] + step, normal);
        if (t >= 0.0 && step.dot(normal) < 0.0) {
          constrain(v, normal, std::min(0.0, t * v.dot(normal)), obstacle.friction);
          memory.active.push_back({i, normal, obstacle.friction});
          clearance[i] = 0.0;
        }
      }
    }
  }

  if (box.enabled) {
    for (std::size_t i = 0; i < n; ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {1.0, -1.0}) {
          const double wall = side > 0.0 ? box.min[axis] : box.max[axis];
          const double gap = side * (positions[i][axis] - wall) - radii[i];
          const double towards = -side * velocities[i][axis] * dt;
          if (!(towards > gap) && gap > 0.0) continue;
          const Vec3 normal = side * Vec3::Unit(axis);
          constrain(velocities[i], normal, leastNormalSpeed(gap, spacing, dt), box.friction);
          memory.active.push_back({static_cast<Index>(i), normal, box.friction});
        }
  }
  std::stable_sort(memory.active.begin(), memory.active.end(),
                   [](const ContactConstraint &a, const ContactConstraint &b) { return a.phyxel < b.phyxel; });
}

void settleContacts(const ContactMemory &memory, std::span<Vec3> velocities) {
  for (const ContactConstraint &contact : memory.active)
    constrain(velocities[contact.phyxel], contact.normal, 0.0, contact.friction);
}

}  // namespace pointbased
