// SPDX-License-Identifier: Apache-2.0
// Deformation gradient for points whose phyxels do not span space. Private to the core.
#pragma once

#include <cmath>

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased::detail {

inline const Mat3 &frameOfPoint(const StencilSet &s, std::size_t q) {
  static const Mat3 identity = Mat3::Identity();
  return s.frameOf[q] == StencilSet::kNoFrame ? identity : s.frames[s.frameOf[q]];
}

/// Unit normal of the plane of a and b; the one at rest, with length 0, if they span no plane.
struct PlaneNormal {
  Vec3 m;
  double length;  ///< |a x b|

  PlaneNormal(const Vec3 &a, const Vec3 &b, const Vec3 &rest) : m(a.cross(b)), length(m.norm()) {
    if (length > 1e-12 * (a.squaredNorm() + b.squaredNorm())) {
      m /= length;
    } else {
      m = rest;
      length = 0.0;
    }
  }
  /// @param turned  change of a x b
  [[nodiscard]] Vec3 differential(const Vec3 &turned) const {
    return length > 0.0 ? Vec3((turned - m * m.dot(turned)) / length) : Vec3(Vec3::Zero());
  }
};

/// Shortest rotation of one direction into another; neither is 0.
Mat3 shortestRotation(const Vec3 &from, const Vec3 &to);

/// Phyxels of a coplanar (rank 2), collinear (1) or single (0) stencil determine only the first `rank` directions of
/// the frame. The others are completed such that a rotation remains a rotation: by the normal of the deformed plane, by
/// the shortest rotation of the line, or by the identity.
inline Mat3 completed(const Mat3 &F, int rank, const Mat3 &frame) {
  if (rank == 0) return Mat3::Identity();
  const Vec3 t1 = frame.col(0), t2 = frame.col(1), n = frame.col(2);
  const Vec3 a = F * t1;
  if (rank == 1) {
    // A line compressed to a point has no direction.
    const Mat3 R = a.squaredNorm() > 0.0 ? shortestRotation(t1, a) : Mat3(Mat3::Identity());
    return a * t1.transpose() + R * (Mat3::Identity() - t1 * t1.transpose());
  }
  const Vec3 b = F * t2;
  return a * t1.transpose() + b * t2.transpose() + PlaneNormal(a, b, n).m * n.transpose();
}

/// d/ds completed(F + s dF) at s = 0. For a line rotated by 180° the part across it is omitted, because it has no
/// derivative.
inline Mat3 completedDifferential(const Mat3 &F, const Mat3 &dF, int rank, const Mat3 &frame) {
  if (rank == 0) return Mat3::Zero();
  const Vec3 t1 = frame.col(0), t2 = frame.col(1), n = frame.col(2);
  const Vec3 a = F * t1, da = dF * t1;
  if (rank == 1) {
    const double length = a.norm();
    if (!(length > 0.0)) return da * t1.transpose();
    // R = c I + [v]x + v v^T / (1 + c), c = t·â, v = t x â
    const Vec3 axis = a / length, dAxis = (da - axis * axis.dot(da)) / length;
    const Vec3 v = t1.cross(axis), dv = t1.cross(dAxis);
    const double c = t1.dot(axis), dc = t1.dot(dAxis);
    if (!(1.0 + c > 1e-12)) return da * t1.transpose();
    Mat3 dR = dc * Mat3::Identity() + (dv * v.transpose() + v * dv.transpose()) / (1.0 + c) -
              v * v.transpose() * (dc / ((1.0 + c) * (1.0 + c)));
    for (int k = 0; k < 3; ++k) dR.col(k) += dv.cross(Vec3::Unit(k));
    return da * t1.transpose() + dR * (Mat3::Identity() - t1 * t1.transpose());
  }
  const Vec3 b = F * t2, db = dF * t2;
  const Vec3 dm = PlaneNormal(a, b, n).differential(da.cross(b) + a.cross(db));
  return da * t1.transpose() + db * t2.transpose() + dm * n.transpose();
}

}  // namespace pointbased::detail
