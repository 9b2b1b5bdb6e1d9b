// SPDX-License-Identifier: Apache-2.0
#include "pointbased/region.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "shape/occupancy_field.h"

namespace pointbased {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

// Distance outside of the slab of each axis. Signs are exact, so the border belongs to the box.
Vec3 excess(const BoxRegion &box, const Vec3 &x) { return (box.min - x).cwiseMax(x - box.max); }

// Axis of the nearest face of a box for a point inside.
Eigen::Index nearestAxis(const Vec3 &outside) {
  Eigen::Index axis = 0;
  outside.maxCoeff(&axis);
  return axis;
}

std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string text(const Vec3 &v) { return "[" + text(v[0]) + ", " + text(v[1]) + ", " + text(v[2]) + "]"; }

}  // namespace

double signedDistance(const Region &region, const Vec3 &x) {
  return std::visit(
      Overloaded{
          [](const EverywhereRegion &) { return -std::numeric_limits<double>::infinity(); },
          [&](const BoxRegion &box) {
            const Vec3 outside = excess(box, x);
            const double largest = outside.maxCoeff();
            return largest > 0.0 ? outside.cwiseMax(0.0).norm() : largest;
          },
          [&](const SphereRegion &sphere) { return (x - sphere.centre).norm() - sphere.radius; },
          [&](const HalfSpaceRegion &half) { return half.normal.dot(x - half.point) / half.normal.norm(); },
          [&](const VoxelRegion &filled) {
            const Vec3 there = x + filled.offset;
            const double about = filled.voxels->about(there);
            // Beyond the grid only a lower bound, the distance to the grid, is available from about().
            return about > 0.0 ? std::max(about, filled.voxels->distance(there)) : about;
          },
      },
      region);
}

bool contains(const Region &region, const Vec3 &x) {
  // For voxels the sign of about() is enough: the exact distance costs several times as much.
  if (const auto *filled = std::get_if<VoxelRegion>(&region)) return filled->voxels->about(x + filled->offset) <= 0.0;
  return signedDistance(region, x) <= 0.0;
}

Vec3 borderNormal(const Region &region, const Vec3 &x) {
  return std::visit(Overloaded{
                        [](const EverywhereRegion &) { return Vec3(Vec3::Zero()); },
                        [&](const BoxRegion &box) {
                          const Vec3 outside = excess(box, x);
                          const Vec3 centre = 0.5 * (box.min + box.max);
                          Vec3 normal = Vec3::Zero();
                          if (outside.maxCoeff() > 0.0) {
                            for (int a = 0; a < 3; ++a)
                              if (outside[a] > 0.0) normal[a] = x[a] > centre[a] ? outside[a] : -outside[a];
                            return Vec3(normal.normalized());
                          }
                          const Eigen::Index axis = nearestAxis(outside);
                          normal[axis] = x[axis] >= centre[axis] ? 1.0 : -1.0;
                          return normal;
                        },
                        [&](const SphereRegion &sphere) {
                          const Vec3 d = x - sphere.centre;
                          const double length = d.norm();
                          return length > 0.0 ? Vec3(d / length) : Vec3(Vec3::UnitX());
                        },
                        [](const HalfSpaceRegion &half) { return Vec3(half.normal.normalized()); },
                        [&](const VoxelRegion &filled) {
                          const double step = 0.5 * filled.voxels->voxel();
                          Vec3 slope;
                          for (int a = 0; a < 3; ++a) {
                            const Vec3 way = step * Vec3::Unit(a);
                            slope[a] = filled.voxels->about(x + filled.offset + way) -
                                       filled.voxels->about(x + filled.offset - way);
                          }
                          const double length = slope.norm();
                          return length > 0.0 ? Vec3(slope / length) : Vec3(Vec3::UnitX());
                        },
                    },
                    region);
}

Region shifted(const Region &region, const Vec3 &offset) {
  return std::visit(Overloaded{
                        [](const EverywhereRegion &all) { return Region(all); },
                        [&](const BoxRegion &box) {
                          return Region(BoxRegion{box.min - offset, box.max - offset});
                        },
                        [&](const SphereRegion &sphere) {
                          return Region(SphereRegion{sphere.centre - offset, sphere.radius});
                        },
                        [&](const HalfSpaceRegion &half) {
                          return Region(HalfSpaceRegion{half.point - offset, half.normal});
                        },
                        [&](const VoxelRegion &voxels) {
                          return Region(VoxelRegion{voxels.voxels, voxels.offset + offset});
                        },
                    },
                    region);
}

Result<void> validate(const Region &region) {
  const auto fail = [](std::string message) -> Result<void> { return tl::make_unexpected(std::move(message)); };
  return std::visit(
      Overloaded{
          [](const EverywhereRegion &) -> Result<void> { return {}; },
          [&](const BoxRegion &box) -> Result<void> {
            if (!box.min.allFinite() || !box.max.allFinite())
              return fail("the region's box from " + text(box.min) + " to " + text(box.max) + " m must be finite");
            if ((box.min.array() > box.max.array()).any())
              return fail("the region's box from " + text(box.min) + " to " + text(box.max) +
                          " m is empty; min must not be larger than max");
            return {};
          },
          [&](const SphereRegion &sphere) -> Result<void> {
            if (!sphere.centre.allFinite())
              return fail("the centre " + text(sphere.centre) + " m of the region's sphere must be finite");
            if (!(sphere.radius > 0.0) || !std::isfinite(sphere.radius))
              return fail("the radius " + text(sphere.radius) + " m of the region's sphere must be above 0");
            return {};
          },
          [&](const HalfSpaceRegion &half) -> Result<void> {
            if (!half.point.allFinite())
              return fail("the point " + text(half.point) + " m of the region's half-space must be finite");
            if (!half.normal.allFinite() || !(half.normal.norm() > 0.0))
              return fail("the normal " + text(half.normal) + " of the region's half-space must have a length above 0");
            return {};
          },
          [&](const VoxelRegion &voxels) -> Result<void> {
            return voxels.voxels ? Result<void>() : fail("the region has no voxels");
          },
      },
      region);
}

}  // namespace pointbased
