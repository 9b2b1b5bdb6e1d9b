// SPDX-License-Identifier: Apache-2.0
#include "tools/arrow_drag.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr double kMinSine = 0.1;  // between the line of sight and a normal along which a pressure is dragged
constexpr double kPascalsPerMmHg = 133.322;

double threeDigits(double value) {
  if (value == 0.0 || !std::isfinite(value)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return unit * std::round(value / unit);
}

Vec3 withSize(const Vec3 &vector, double largest) {
  const double size = vector.norm();
  return size > 0.0 ? Vec3(std::min(threeDigits(size), largest) / size * vector) : Vec3(Vec3::Zero());
}

}  // namespace

ConditionArrow arrowOf(const ConditionSnapshot &one, const SurfaceCondition &value, double metresPerNewton) {
  ConditionArrow arrow;
  for (const Vec3 &x : one.positions) arrow.from += x / static_cast<double>(one.positions.size());
  arrow.area = areaVectorOf({one.positions, value.patch.triangles});
  switch (value.kind) {
    case ConditionKind::fix: break;
    case ConditionKind::displace: arrow.vector = value.vector; break;
    case ConditionKind::force: arrow.vector = metresPerNewton * value.vector; break;
    case ConditionKind::pressure: arrow.vector = -metresPerNewton * value.pressure * arrow.area; break;
  }
  return arrow;
}

ConditionArrow arrowOf(const ConditionSnapshot &one, double metresPerNewton) {
  return arrowOf(one, one.condition, metresPerNewton);
}

double forceOf(const ConditionSnapshot &one) {
  if (one.condition.kind == ConditionKind::force) return one.condition.vector.norm();
  if (one.condition.kind != ConditionKind::pressure) return 0.0;
  return std::abs(one.condition.pressure) * areaVectorOf({one.positions, one.condition.patch.triangles}).norm();
}

std::optional<Vec3> tipUnder(const PickRay &ray, const ConditionArrow &arrow, ConditionKind kind, bool isSlice) {
  if (kind == ConditionKind::pressure) {
    if (!(arrow.area.norm() > 0.0)) return std::nullopt;
    const Vec3 axis = arrow.area.normalized();
    const double c = axis.dot(ray.direction);
    if (1.0 - c * c < kMinSine * kMinSine) return std::nullopt;
    const Vec3 off = arrow.from - ray.origin;
    return arrow.from + (c * off.dot(ray.direction) - off.dot(axis)) / (1.0 - c * c) * axis;
  }
  const double along = ray.direction.dot(ray.view);
  if (std::abs(along) < 1e-9) return std::nullopt;
  const double t = (arrow.tip() - ray.origin).dot(ray.view) / along;
  if (!isSlice && t <= 0.0) return std::nullopt;
  return ray.origin + t * ray.direction;
}

SurfaceCondition withArrow(const SurfaceCondition &condition, const ConditionArrow &arrow, const Vec3 &vector,
                           double metresPerNewton) {
  SurfaceCondition out = condition;
  const double square = arrow.area.squaredNorm();
  switch (condition.kind) {
    case ConditionKind::fix: break;
    case ConditionKind::displace: out.vector = withSize(vector, kMaxDisplacement); break;
    case ConditionKind::force:
      if (metresPerNewton > 0.0) out.vector = withSize(vector / metresPerNewton, kMaxForce);
      break;
    case ConditionKind::pressure:
      if (metresPerNewton > 0.0 && square > 0.0)
        out.pressure =
            std::clamp(threeDigits(-vector.dot(arrow.area) / square / metresPerNewton), -kMaxPressure, kMaxPressure);
      break;
  }
  return out;
}

std::string valueText(const SurfaceCondition &one) {
  switch (one.kind) {
    case ConditionKind::fix: return one.name;
    case ConditionKind::displace: return significant(1e3 * one.vector.norm(), 4) + " mm";
    case ConditionKind::force: return significant(one.vector.norm(), 4) + " N";
    case ConditionKind::pressure:
      return significant(1e-3 * one.pressure, 4) + " kPa (" + significant(one.pressure / kPascalsPerMmHg, 4) + " mmHg)";
  }
  return {};
}

}  // namespace pointbased
