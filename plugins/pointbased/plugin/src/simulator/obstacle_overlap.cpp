// SPDX-License-Identifier: Apache-2.0
#include "simulator/obstacle_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointbased {
namespace {

constexpr double kTouching = 5e-4;  // m: skin at a smaller depth in an obstacle only touches it

// Distances, m, of points from the surface of an obstacle at its present position; negative inside. Infinite for points
// that are at least `near` outside its box.
std::vector<double> distancesFrom(const Simulator &simulator, const BodyTable &table, std::uint64_t id,
                                  std::span<const Vec3> points, double margin) {
  std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
  const Obstacle *obstacle = simulator.world().obstacle(id);
  if (!obstacle || !obstacle->closest) return distances;
  const RigidMotion motion = simulator.world().obstacleMotion(id);
  const PlacedMesh &mesh = *table.obstacle(id)->mesh;
  std::vector<Vec3> positions;  // in its frame at rest
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 at = motion.rotation.transpose() * (points[k] - motion.centre - motion.displacement) + motion.centre;
    if ((at.array() < mesh.min.array() - margin).any() || (at.array() > mesh.max.array() + margin).any()) continue;
    positions.push_back(at);
    which.push_back(k);
  }
  const std::vector<double> ranges(positions.size(), (mesh.max - mesh.min).norm());
  std::vector<SurfacePoint> found(positions.size());
  obstacle->closest(positions, ranges, found);
  for (std::size_t k = 0; k < positions.size(); ++k) distances[which[k]] = found[k].distance;
  return distances;
}

}  // namespace

double displacedVolume(const Simulator &simulator, const BodyTable &table, std::uint64_t id) {
  double sum = 0.0;
  for (const auto &[body, record] : table.bodies()) {
    const RestState &rest = simulator.body(body)->rest();
    std::vector<Vec3> positions(rest.pointCentres.begin(), rest.pointCentres.end());
    for (Vec3 &x : positions) x += rest.origin;
    const std::vector<double> &volumes = rest.stencils.volumes;
    const double largest = volumes.empty() ? 0.0 : *std::max_element(volumes.begin(), volumes.end());
    const std::vector<double> distances = distancesFrom(simulator, table, id, positions, 0.5 * std::cbrt(largest));
    for (std::size_t q = 0; q < positions.size(); ++q)
      sum += volumes[q] * std::clamp(0.5 - distances[q] / std::cbrt(volumes[q]), 0.0, 1.0);
  }
  return sum;
}

bool containsSkin(Simulator &simulator, const BodyTable &table, std::uint64_t id) {
  return std::any_of(table.bodies().begin(), table.bodies().end(), [&](const auto &entry) {
    std::vector<Vec3> positions, normals;
    simulator.world().surfels(entry.first, positions, normals);
    const std::vector<double> distances = distancesFrom(simulator, table, id, positions, 0.0);
    return std::any_of(distances.begin(), distances.end(), [](double d) { return d < -kTouching; });
  });
}

}  // namespace pointbased
