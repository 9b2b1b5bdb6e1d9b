// SPDX-License-Identifier: Apache-2.0
#include "simulator/surface_condition.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr std::size_t kMaxTriangles = 2'000'000;

Vec3 triangleVector(const SurfacePatch &patch, std::size_t triangle) {
  const auto &[a, b, c] = patch.triangles[triangle];
  return 0.5 * (patch.positions[b] - patch.positions[a]).cross(patch.positions[c] - patch.positions[a]);
}

std::string outOfRange(const std::string &what, double value, const std::string &unit, double largest) {
  return what + " is " + significant(value) + " " + unit + "; accepted: up to " + significant(largest) + " " + unit;
}

}  // namespace

double areaOf(const SurfacePatch &patch) {
  double sum = 0.0;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) sum += triangleVector(patch, t).norm();
  return sum;
}

Vec3 areaVectorOf(const SurfacePatch &patch) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) sum += triangleVector(patch, t);
  return sum;
}

std::string_view nameOf(ConditionKind kind) {
  constexpr std::array<std::string_view, 4> kNames{"fix", "displace", "force", "pressure"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string problemOf(const SurfaceCondition &one) {
  if (one.patch.triangles.empty()) return "the selection is empty; accepted: one triangle of the surface or more";
  if (one.patch.triangles.size() > kMaxTriangles)
    return "the selection has " + std::to_string(one.patch.triangles.size()) + " triangles; accepted: up to " +
           std::to_string(kMaxTriangles);
  for (const auto &triangle : one.patch.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= one.patch.positions.size()) return "a triangle of the selection has a corner that does not exist";
  for (const Vec3 &x : one.patch.positions)
    if (!x.allFinite()) return "a point of the selection is not finite";
  if (!(areaOf(one.patch) > 0.0)) return "the selection has no area; accepted: above 0 mm²";
  if (one.kind > ConditionKind::pressure) return "its kind is not known; accepted: fix, displace, force, pressure";
  if (!one.vector.allFinite() || !std::isfinite(one.pressure)) return "its value is not a number";
  const double size = one.vector.norm();
  if (one.kind == ConditionKind::force && size > kMaxForce) return outOfRange("the force", size, "N", kMaxForce);
  if (one.kind == ConditionKind::displace && size > kMaxDisplacement)
    return outOfRange("the displacement", 1e3 * size, "mm", 1e3 * kMaxDisplacement);
  if (one.kind == ConditionKind::pressure && std::abs(one.pressure) > kMaxPressure)
    return outOfRange("the pressure", 1e-3 * std::abs(one.pressure), "kPa", 1e-3 * kMaxPressure);
  if (!(one.ramp >= 0.0 && one.ramp <= kMaxRamp))
    return "the time is " + significant(one.ramp) + " s; accepted: 0 … " + significant(kMaxRamp) + " s";
  return {};
}

}  // namespace pointbased
