// SPDX-License-Identifier: Apache-2.0
// Isotropic control for clouds: penalises the deviation of the phyxels of a stencil from the affine fit, in the
// directions that the stencil spans. Across a plane and a line phyxels are free. Private to the core.
#pragma once

#include "discretisation/rank_deficient_gradient.h"
#include "pointbased/material.h"

namespace pointbased::detail {

/// Stiffness that scales the energy of a point, N/m.
inline double residualScale(const Material &material, double stabilisation, double volume) {
  return stabilisation * material.youngsModulus * volume;
}

/// One entry of a point relative to the anchor.
struct Offset {
  Vec3 rest;  ///< without strain
  Vec3 now;
  Offset(const StencilSet &s, std::size_t q, std::span<const Vec3> X, std::span<const Vec3> u, Index k, Index anchor)
      : rest(X[k] - X[anchor]), now(rest + (u[k] - u[anchor])) {
    rest = s.unstrained(q, rest);
  }
};

/// r_k and its change, U_q = scale/2 Σ w_k |r_k|². For a plane r is projected onto the deformed plane, for a line onto
/// the deformed line: a sheet bends freely, and bending does not shear it.
class StabilisationPoint {
 public:
  StabilisationPoint(const StencilSet &s, std::size_t q, const Mat3 &F)
      : s_(s), q_(q), rank_(s.rank[q]), frame_(frameOfPoint(s, q)), F_(F), first_(s.phyxels.offsets[q]),
        last_(s.phyxels.offsets[q + 1]), anchor_(s.phyxels.indices[first_]), a_(F * frame_.col(0)), length_(a_.norm()),
        axis_(length_ > 0.0 ? Vec3(a_ / length_) : Vec3(Vec3::Zero())) {
    if (rank_ == 2) axis_ = PlaneNormal(a_, F * frame_.col(1), frame_.col(2)).m;
  }

  /// dU/dx_k = scale w_k direction, U = scale/2 Σ w_k |direction|².
  [[nodiscard]] Vec3 direction(const Offset &o) const {
    if (rank_ == 1) return along(o) * axis_;
    if (rank_ == 2) return inPlane(missed(o));
    return o.now - F_ * o.rest;
  }

  /// @param dF  change of the completed F
  [[nodiscard]] Vec3 directionDifferential(const Offset &o, const Vec3 &dnow, const Mat3 &dF) const {
    if (rank_ == 1) {
      const LineChange c = lineChange(dF);
      return alongDifferential(o, dnow, c) * axis_ + along(o) * c.axis;
    }
    if (rank_ == 2) {
      const Vec3 r = missed(o), dr = missedDifferential(o, dnow, dF), dm = normalDifferential(dF);
      return inPlane(dr) - dm * axis_.dot(r) - axis_ * dm.dot(r);
    }
    return dnow - dF * o.rest;
  }

  /// Projector onto the displacements that change r.
  [[nodiscard]] Mat3 visibleDirections() const {
    if (rank_ == 1) return axis_ * axis_.transpose();
    if (rank_ == 2) return Mat3::Identity() - axis_ * axis_.transpose();
    return Mat3::Identity();
  }

  /// dU_q/dF over scale. Zero for a full stencil, whose residual is orthogonal to the fit, and along the spanned
  /// directions of a flat one, whose normal or axis rotates with F.
  [[nodiscard]] Mat3 stress(std::span<const Vec3> X, std::span<const Vec3> u) const {
    if (rank_ == 1) return length_ > 0.0 ? Mat3(lineSum(X, u) * frame_.col(0).transpose()) : Mat3(Mat3::Zero());
    if (rank_ != 2) return Mat3::Zero();
    const Vec3 b = F_ * frame_.col(1);
    const PlaneNormal normal(a_, b, frame_.col(2));
    if (!(normal.length > 0.0)) return Mat3::Zero();
    return planeStress(b, inPlane(normalPull(X, u)), normal.length);
  }

  /// @param du  change of the displacements that corresponds to dF
  [[nodiscard]] Mat3 stressDifferential(std::span<const Vec3> X, std::span<const Vec3> u, std::span<const Vec3> du,
                                        const Mat3 &dF) const {
    if (rank_ == 1) return length_ > 0.0 ? lineStressDifferential(X, u, du, dF) : Mat3(Mat3::Zero());
    if (rank_ != 2) return Mat3::Zero();
    const Vec3 b = F_ * frame_.col(1), da = dF * frame_.col(0), db = dF * frame_.col(1);
    const PlaneNormal normal(a_, b, frame_.col(2));
    if (!(normal.length > 0.0)) return Mat3::Zero();
    const Vec3 turned = da.cross(b) + a_.cross(db);
    const Vec3 dm = normal.differential(turned);
    const Vec3 y = normalPull(X, u);
    Vec3 dy = Vec3::Zero();
    for (Index e = first_ + 1; e < last_; ++e) {
      const Index k = s_.phyxels.indices[e];
      const Offset o(s_, q_, X, u, k, anchor_);
      const Vec3 r = missed(o), dr = missedDifferential(o, du[k] - du[anchor_], dF);
      dy -= s_.weights[e] * ((dm.dot(r) + axis_.dot(dr)) * r + axis_.dot(r) * dr);
    }
    const Vec3 &m = normal.m;
    const Vec3 across = inPlane(y);
    const Vec3 dAcross = dy - dm * m.dot(y) - m * (dm.dot(y) + m.dot(dy));
    return planeStress(b, dAcross, normal.length) +
           (db.cross(across) * frame_.col(0).transpose() + across.cross(da) * frame_.col(1).transpose()) /
               normal.length -
           planeStress(b, across, normal.length) * (m.dot(turned) / normal.length);
  }

 private:
  struct LineChange {
    double length;
    Vec3 axis;
  };

  [[nodiscard]] double along(const Offset &o) const { return o.now.dot(axis_) - length_ * o.rest.dot(frame_.col(0)); }
  [[nodiscard]] LineChange lineChange(const Mat3 &dF) const {
    if (!(length_ > 0.0)) return {0.0, Vec3::Zero()};
    const Vec3 da = dF * frame_.col(0);
    const double d = axis_.dot(da);
    return {d, (da - axis_ * d) / length_};
  }
  [[nodiscard]] double alongDifferential(const Offset &o, const Vec3 &dnow, const LineChange &c) const {
    return dnow.dot(axis_) + o.now.dot(c.axis) - c.length * o.rest.dot(frame_.col(0));
  }
  /// d along / da
  [[nodiscard]] Vec3 slope(const Offset &o) const {
    return (o.now - axis_ * axis_.dot(o.now)) / length_ - axis_ * o.rest.dot(frame_.col(0));
  }
  [[nodiscard]] Vec3 lineSum(std::span<const Vec3> X, std::span<const Vec3> u) const {
    Vec3 sum = Vec3::Zero();
    for (Index e = first_ + 1; e < last_; ++e) {
      const Offset o(s_, q_, X, u, s_.phyxels.indices[e], anchor_);
      sum += s_.weights[e] * along(o) * slope(o);
    }
    return sum;
  }
  [[nodiscard]] Mat3 lineStressDifferential(std::span<const Vec3> X, std::span<const Vec3> u, std::span<const Vec3> du,
                                            const Mat3 &dF) const {
    const LineChange c = lineChange(dF);
    Vec3 sum = Vec3::Zero();
    for (Index e = first_ + 1; e < last_; ++e) {
      const Index k = s_.phyxels.indices[e];
      const Offset o(s_, q_, X, u, k, anchor_);
      const Vec3 dnow = du[k] - du[anchor_];
      const Vec3 across = o.now - axis_ * axis_.dot(o.now);
      const Vec3 dAcross = dnow - c.axis * axis_.dot(o.now) - axis_ * (c.axis.dot(o.now) + axis_.dot(dnow));
      const Vec3 dSlope = (dAcross - across * (c.length / length_)) / length_ - c.axis * o.rest.dot(frame_.col(0));
      sum += s_.weights[e] * (alongDifferential(o, dnow, c) * slope(o) + along(o) * dSlope);
    }
    return sum * frame_.col(0).transpose();
  }
  [[nodiscard]] Vec3 inPlane(const Vec3 &v) const { return v - axis_ * axis_.dot(v); }
  /// Residual of a plane in its two directions; the completed third one is perpendicular to it and does not contribute.
  [[nodiscard]] Vec3 missed(const Offset &o) const {
    return o.now - F_ * (o.rest - frame_.col(2) * frame_.col(2).dot(o.rest));
  }
  [[nodiscard]] Vec3 missedDifferential(const Offset &o, const Vec3 &dnow, const Mat3 &dF) const {
    return dnow - dF * (o.rest - frame_.col(2) * frame_.col(2).dot(o.rest));
  }
  [[nodiscard]] Vec3 normalDifferential(const Mat3 &dF) const {
    const Vec3 b = F_ * frame_.col(1);
    return PlaneNormal(a_, b, frame_.col(2)).differential((dF * frame_.col(0)).cross(b) + a_.cross(dF * frame_.col(1)));
  }
  /// dU/dm over scale, m the normal: -Σ w (m·r) r.
  [[nodiscard]] Vec3 normalPull(std::span<const Vec3> X, std::span<const Vec3> u) const {
    Vec3 y = Vec3::Zero();
    for (Index e = first_ + 1; e < last_; ++e) {
      const Vec3 r = missed(Offset(s_, q_, X, u, s_.phyxels.indices[e], anchor_));
      y -= s_.weights[e] * axis_.dot(r) * r;
    }
    return y;
  }
  [[nodiscard]] Mat3 planeStress(const Vec3 &b, const Vec3 &y, double length) const {
    return (b.cross(y) * frame_.col(0).transpose() + y.cross(a_) * frame_.col(1).transpose()) / length;
  }

  const StencilSet &s_;
  std::size_t q_;
  int rank_;
  const Mat3 &frame_;
  const Mat3 &F_;
  Index first_, last_, anchor_;
  Vec3 a_;
  double length_;
  Vec3 axis_;  // direction of a line, normal of a plane
};

}  // namespace pointbased::detail
