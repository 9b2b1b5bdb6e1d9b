// SPDX-License-Identifier: Apache-2.0
#include "pointbased/supports.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/expects.h"
#include "base/point_tree.h"
#include "base/polar.h"
#include "discretisation/interpolation_at.h"

namespace pointbased {

using namespace detail;

namespace {

// Spacings: phyxels this close to a region are inside, as coordinates may be rounded.
constexpr double kTolerance = 1e-9;

// Spacings: samples of a held or loaded surface. Means over patches and shares of phyxels then hardly depend on their
// positions.
constexpr double kSurfaceSampling = 0.5;

const char *const kMeetsNothing =
    "the region meets no part of the body; move or enlarge it until it holds a part of the surface or a phyxel";

constexpr double kRadians = std::numbers::pi / 180.0;

Mat3 about(int axis, double angle) { return Eigen::AngleAxisd(angle, Vec3::Unit(axis)).toRotationMatrix(); }

Mat3 aboutAxis(const Vec3 &rotationVector) {
  const double angle = rotationVector.norm();
  if (angle == 0.0) return Mat3::Identity();
  return Eigen::AngleAxisd(angle, rotationVector / angle).toRotationMatrix();
}

// d/dangle of about(): [e]x R
Mat3 rateAbout(int axis, double angle) {
  const Mat3 R = about(axis, angle);
  Mat3 rate;
  for (int k = 0; k < 3; ++k) rate.col(k) = Vec3::Unit(axis).cross(Vec3(R.col(k)));
  return rate;
}

Vec3 centreOf(const Fix &fix, const ConstrainedRegion &part, const Vec3 &origin) {
  return fix.centre ? Vec3(*fix.centre - origin) : part.centroid;
}

// Mean φ of the samples around each nearest phyxel; one row per such phyxel that has free neighbours to hold.
void addPatches(const SurfacePoints &samples, std::span<const Vec3> positions, std::span<const std::uint8_t> isHeld,
                const ParallelFor &parallelFor, ConstrainedRegion &part) {
  const Interpolation binding = bindToCloud(samples.positions, positions, parallelFor);
  const PointTree tree(positions);
  std::vector<Index> nearest(samples.count());
  for (std::size_t p = 0; p < samples.count(); ++p) {
    double squared = 0.0;
    tree.nearest(samples.positions[p], 1, &nearest[p], &squared);
  }
  std::vector<std::size_t> order(samples.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nearest[a] < nearest[b]; });

  std::vector<std::pair<Index, double>> row;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    double area = 0.0;
    row.clear();
    for (last = first; last < order.size() && nearest[order[last]] == nearest[order[first]]; ++last) {
      const std::size_t p = order[last];
      area += samples.areas[p];
      for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
        row.emplace_back(binding.phyxels.indices[e], samples.areas[p] * binding.weights[e]);
    }
    if (std::all_of(row.begin(), row.end(), [&](const auto &entry) { return isHeld[entry.first] != 0; })) continue;
    std::stable_sort(row.begin(), row.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
    const std::size_t rowBegin = part.rows.indices.size();
    for (const auto &[phyxel, weight] : row) {
      if (part.rows.indices.size() > rowBegin && part.rows.indices.back() == phyxel) {
        part.weights.back() += weight / area;
      } else {
        part.rows.indices.push_back(phyxel);
        part.weights.push_back(weight / area);
      }
    }
    part.rows.offsets.push_back(static_cast<Index>(part.rows.indices.size()));
    part.areas.push_back(area);
    part.stiffness.push_back(kPatchStiffness);
  }
}

}  // namespace

RigidMotion motionAt(const Fix &fix, const ConstrainedRegion &part, const Vec3 &origin, double s) {
  RigidMotion motion;
  if (fix.rotationVector) {
    motion.rotation = aboutAxis(s * *fix.rotationVector);
  } else {
    const Vec3 angles = s * kRadians * fix.rotation_deg;
    motion.rotation = about(2, angles[2]) * about(1, angles[1]) * about(0, angles[0]);
  }
  motion.centre = centreOf(fix, part, origin);
  motion.displacement = s * fix.displacement;
  return motion;
}

Vec3 motionRate(const Fix &fix, const ConstrainedRegion &part, const Vec3 &origin, double s, const Vec3 &X) {
  if (fix.rotationVector)
    return fix.rotationVector->cross(aboutAxis(s * *fix.rotationVector) * (X - centreOf(fix, part, origin))) +
           fix.displacement;
  const Vec3 rates = kRadians * fix.rotation_deg, angles = s * rates;
  const Mat3 Rx = about(0, angles[0]), Ry = about(1, angles[1]), Rz = about(2, angles[2]);
  const Mat3 rate = rates[2] * rateAbout(2, angles[2]) * Ry * Rx + rates[1] * Rz * rateAbout(1, angles[1]) * Rx +
                    rates[0] * Rz * Ry * rateAbout(0, angles[0]);
  return rate * (X - centreOf(fix, part, origin)) + fix.displacement;
}

Result<ConstrainedRegion> holdCloud(const Region &region, std::span<const Vec3> positions,
                                    std::span<const double> volumes, double spacing, const Surface &surface,
                                    const ParallelFor &parallelFor) {
  if (const auto valid = validate(region); !valid) return tl::make_unexpected(valid.error());
  ConstrainedRegion part;

  // Phyxels represent the volume inside.
  std::vector<std::uint8_t> isHeld(positions.size(), 0);
  Vec3 volumeMoment = Vec3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!(signedDistance(region, positions[i]) <= kTolerance * spacing)) continue;
    isHeld[i] = 1;
    part.phyxels.push_back(static_cast<Index>(i));
    part.volume += volumes[i];
    volumeMoment += volumes[i] * positions[i];
  }

  // The surface inside is held on average, patch by patch.
  Vec3 areaMoment = Vec3::Zero();
  if (!positions.empty()) {
    const SurfacePoints samples = sampleSurface(surface, kSurfaceSampling * spacing, region);
    for (std::size_t p = 0; p < samples.count(); ++p) {
      part.area += samples.areas[p];
      areaMoment += samples.areas[p] * samples.positions[p];
    }
    addPatches(samples, positions, isHeld, parallelFor, part);
  }

  if (part.empty()) return tl::make_unexpected(std::string(kMeetsNothing));
  if (part.volume > 0.0) {
    part.centroid = volumeMoment / part.volume;
  } else if (part.area > 0.0) {
    part.centroid = areaMoment / part.area;
  }
  return part;
}

Result<LoadedPart> loadedPart(const Load &load, const Surface &surface, double spacing, const Binder &bind,
                              std::span<const Vec3> volumePoints, std::span<const double> volumes) {
  if (const auto valid = validate(load.region); !valid) return tl::make_unexpected(valid.error());
  if (!load.force.allFinite() || !std::isfinite(load.pressure))
    return tl::make_unexpected(std::string("force and pressure must be finite numbers"));
  LoadedPart part;

  const SurfacePoints samples = sampleSurface(surface, kSurfaceSampling * spacing, load.region);
  if (samples.count() > 0) {
    part.area = std::accumulate(samples.areas.begin(), samples.areas.end(), 0.0);
    part.points = bind(samples.positions, samples.normals);
    part.areaVectors.reserve(samples.count());
    part.shares.reserve(samples.count());
    for (std::size_t p = 0; p < samples.count(); ++p) {
      part.areaVectors.push_back(samples.areas[p] * samples.normals[p]);
      part.shares.push_back(samples.areas[p] / part.area);
    }
    return part;
  }

  // No surface inside: a force acts evenly on the volume there.
  std::vector<Vec3> inside;
  double volume = 0.0;
  for (std::size_t i = 0; i < volumePoints.size(); ++i) {
    if (!(signedDistance(load.region, volumePoints[i]) <= kTolerance * spacing) || !(volumes[i] > 0.0)) continue;
    inside.push_back(volumePoints[i]);
    part.shares.push_back(volumes[i]);
    volume += volumes[i];
  }
  if (inside.empty()) return tl::make_unexpected(std::string(kMeetsNothing));
  if (load.pressure != 0.0)
    return tl::make_unexpected(std::string(
        "a pressure acts on a surface, but the region contains only volume of the body; let it contain a part of "
        "the surface, or give a force"));
  for (double &share : part.shares) share /= volume;
  part.points = bind(inside, {});
  part.areaVectors.assign(inside.size(), Vec3::Zero());
  return part;
}

void addLoadForces(const Load &load, const LoadedPart &part, double s, std::span<const Vec3> displacements,
                   std::span<Vec3> forces) {
  const bool presses = load.pressure != 0.0;
  POINTBASED_EXPECTS(displacements.size() == forces.size() || !(presses && load.follower),
                     "one displacement per phyxel where a pressure follows the surface");
  for (std::size_t p = 0; p < part.points.count(); ++p) {
    Vec3 force = (s * part.shares[p]) * load.force;
    if (presses) {
      const Vec3 &N = part.areaVectors[p];
      const Vec3 n = load.follower ? Vec3(cofactor(gradientAt(part.points, p, displacements)) * N) : N;
      force -= (s * load.pressure) * n;
    }
    spreadForce(part.points, p, force, forces);
  }
}

}  // namespace pointbased
