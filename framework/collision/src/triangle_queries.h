// SPDX-License-Identifier: Apache-2.0
// Ray and closest point on one triangle.
#pragma once

#include <cstddef>

#include "c3de/core/vec.h"

namespace c3de::collision {

/// A ray prepared so that two triangles with a common edge use the same numbers: no ray passes between them. Both faces
/// are hit.
/// @source Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2013
class WatertightRay {
 public:
  /// @pre  direction is finite and not zero
  WatertightRay(const Vec3 &origin, const Vec3 &direction);

  struct Hit {
    double t = 0.0;
    Vec3 bary{};
  };
  /// False for a triangle that is missed, seen edge-on or without area. t may be negative.
  [[nodiscard]] bool intersect(const Vec3 &a, const Vec3 &b, const Vec3 &c, Hit &hit) const;

  [[nodiscard]] const Vec3 &origin() const { return origin_; }

 private:
  Vec3 origin_;
  std::size_t kx_ = 0, ky_ = 1, kz_ = 2;
  double shearX_ = 0.0, shearY_ = 0.0, scaleZ_ = 1.0;
};

enum class Feature { face, edgeAB, edgeBC, edgeCA, cornerA, cornerB, cornerC };

struct TrianglePoint {
  Vec3 point{}, bary{};
  double distanceSquared = 0.0;
  Feature feature = Feature::face;
};
/// Triangles without area are treated as segments or points.
[[nodiscard]] TrianglePoint closestOnTriangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c);

}  // namespace c3de::collision
