// SPDX-License-Identifier: Apache-2.0
#include "pointbased/occupancy.h"

#include <Eigen/LU>
#include <cmath>
#include <memory>

#include "base/number_text.h"
#include "shape/occupancy_field.h"

namespace pointbased {

using detail::number;

namespace {

Result<void> check(const Occupancy &occupancy) {
  const auto refuse = [](const std::string &text) { return tl::unexpected<std::string>(text); };
  const auto &n = occupancy.size;
  const std::string grid = std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
  if (n[0] * n[1] * n[2] != occupancy.fill.size() || occupancy.fill.empty())
    return refuse("the occupancy has " + std::to_string(occupancy.fill.size()) + " values for a grid of " + grid +
                  " voxels");
  const Mat3 &steps = occupancy.steps;
  const double longest = steps.colwise().norm().maxCoeff();
  if (!steps.allFinite() || !occupancy.origin.allFinite() || !(longest > 0.0) ||
      !(std::abs(steps.determinant()) > 1e-9 * longest * longest * longest))
    return refuse("the steps between the voxels of the occupancy span no volume, or are not finite");
  double most = 0.0;
  for (std::size_t v = 0; v < occupancy.fill.size(); ++v) {
    const auto fill = static_cast<double>(occupancy.fill[v]);
    if (!(fill >= 0.0 && fill <= 1.0 + 1e-6))
      return refuse("voxel (" + std::to_string(v % n[0]) + ", " + std::to_string(v / n[0] % n[1]) + ", " +
                    std::to_string(v / (n[0] * n[1])) + ") of the occupancy has a fill of " + number(fill, 4) +
                    "; 0 … 1 is accepted");
    most = std::max(most, fill);
  }
  if (!(most > 1e-6)) return refuse("no voxel of the occupancy is filled");
  return {};
}

}  // namespace

Result<BodyShape> shapeOf(const Occupancy &occupancy, Surface surface, const ParallelFor &parallelFor) {
  if (const auto good = check(occupancy); !good) return tl::unexpected<std::string>(good.error());
  const auto field = std::make_shared<const detail::OccupancyField>(occupancy, parallelFor);
  BodyShape shape;
  shape.min = field->min();
  shape.max = field->max();
  shape.volume = field->volume();
  shape.inside = [field](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = field->fillAt(points[i]);
  };
  shape.surfaceDistance = [field](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = field->distance(points[i]);
  };
  shape.shares = [field](std::span<const Vec3> middles, const Mat3 &axes, double edge, std::span<double> parts,
                         std::span<double> distances) {
    field->shares(middles, axes, edge, parts);
    for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = field->about(middles[i]);
  };
  shape.crosses = [field](std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses) {
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = field->crosses(from[i], to[i]) ? 1 : 0;
  };
  shape.surface = std::move(surface);
  return shape;
}

Result<Region> regionOf(const Occupancy &occupancy, const ParallelFor &parallelFor) {
  if (const auto good = check(occupancy); !good) return tl::unexpected<std::string>(good.error());
  return Region(VoxelRegion{std::make_shared<const detail::OccupancyField>(occupancy, parallelFor)});
}

}  // namespace pointbased
