// SPDX-License-Identifier: Apache-2.0
#include "body/rigid_frame.h"

#include <cmath>

#include "base/polar.h"
#include "base/symmetric_eigen.h"

namespace pointbased::detail {
namespace {

// Corners of a tetrahedron: mean 0, and the mean of t tᵀ is 1.
Vec3 cornerOf(std::size_t k) { return {k < 2 ? 1.0 : -1.0, k % 2 == 0 ? 1.0 : -1.0, k == 0 || k == 3 ? 1.0 : -1.0}; }
constexpr double kNoExtent = 1e-6;  // of the largest extent: phyxels with less are in a plane
constexpr int kMaxIterations = 60;

Mat3 rotationBy(const Vec3 &angle) {
  const double size = angle.norm();
  return size > 0.0 ? Eigen::AngleAxisd(size, angle / size).toRotationMatrix() : Mat3(Mat3::Identity());
}

}  // namespace

RigidFrame::RigidFrame(std::span<const Vec3> positions, std::span<const double> masses, double spacing) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    mass_ += masses[i];
    centre_ += masses[i] * positions[i];
  }
  centre_ /= mass_;
  Mat3 second = Mat3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i)
    second += masses[i] * (positions[i] - centre_) * (positions[i] - centre_).transpose();
  const SymmetricEigen principal = symmetricEigen(second);
  axes_ = principal.vectors;
  if (axes_.determinant() < 0.0) axes_.col(0) *= -1.0;
  const Vec3 found = principal.values.cwiseMax(0.0);
  const Vec3 squares = (found / mass_).cwiseMax(spacing * spacing / 12.0);
  extents_ = squares.cwiseSqrt();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    moments_[a] = mass_ * (squares[b] + squares[c]);
    const double seen = found[b] + found[c];
    seen_[a] = seen > kNoExtent * kNoExtent * found.maxCoeff() ? seen : 0.0;
  }
  for (const Vec3 &X : positions) {
    const Vec3 along = (axes_.transpose() * (X - centre_)).cwiseQuotient(extents_);
    std::array<double, 4> &weights = weights_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) weights[k] = 0.25 * (1.0 + cornerOf(k).dot(along));
  }
}

Mat3 RigidFrame::inverseInertia(const RigidPose &pose) const {
  const Mat3 axes = pose.rotation * axes_;
  return axes * moments_.cwiseInverse().asDiagonal() * axes.transpose();
}

double RigidFrame::largestInverseMassAt(const RigidPose &pose, const Vec3 &arm) const {
  Mat3 across;
  across << 0.0, -arm[2], arm[1], arm[2], 0.0, -arm[0], -arm[1], arm[0], 0.0;
  const Mat3 turning = across.transpose() * inverseInertia(pose) * across;
  return 1.0 / mass_ + largestEigenvalueBound(turning);
}

RigidPose RigidFrame::poseOf(std::span<const Vec3> positions, std::span<const Vec3> displacements,
                             std::span<const double> masses) const {
  RigidPose pose;
  Vec3 way = Vec3::Zero();
  // Relative to the first one, here and below: common offsets cause no rounding error.
  for (std::size_t i = 0; i < positions.size(); ++i) way += masses[i] * (displacements[i] - displacements[0]);
  way = displacements[0] + way / mass_;
  pose.centre = centre_ + way;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 arm = positions[i] - centre_;
    covariance += masses[i] * (arm + displacements[i] - way) * arm.transpose();
  }
  pose.rotation = polarBySvd(covariance).R;
  return pose;
}

RigidVelocity RigidFrame::velocityOf(const RigidPose &pose, std::span<const Vec3> positions,
                                     std::span<const Vec3> velocities, std::span<const double> masses) const {
  RigidVelocity motion;
  for (std::size_t i = 0; i < positions.size(); ++i) motion.velocity += masses[i] * (velocities[i] - velocities[0]);
  motion.velocity = velocities[0] + motion.velocity / mass_;
  const Mat3 axes = pose.rotation * axes_;
  // The second pass corrects the residual of the first. Otherwise a spin recomputed in every step would grow by
  // rounding.
  for (int pass = 0; pass < 2; ++pass) {
    Vec3 moment = Vec3::Zero();
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3 arm = pose.rotation * (positions[i] - centre_);
      moment += masses[i] * arm.cross(velocities[i] - motion.velocity - motion.spin.cross(arm));
    }
    // Uses the moments of the phyxels alone: rotation is conserved even if they are in a plane.
    Vec3 along = axes.transpose() * moment;
    for (int a = 0; a < 3; ++a) along[a] = seen_[a] > 0.0 ? along[a] / seen_[a] : 0.0;
    motion.spin += axes * along;
  }
  return motion;
}

void RigidFrame::place(const RigidPose &pose, std::span<const Vec3> positions, std::span<Vec3> displacements) const {
  const Mat3 turn = pose.rotation - Mat3::Identity();
  const Vec3 way = pose.centre - centre_;
  for (std::size_t i = 0; i < positions.size(); ++i) displacements[i] = way + turn * (positions[i] - centre_);
}

void RigidFrame::move(const RigidPose &pose, const RigidVelocity &motion, std::span<const Vec3> positions,
                      std::span<Vec3> velocities) const {
  for (std::size_t i = 0; i < positions.size(); ++i)
    velocities[i] = motion.velocity + motion.spin.cross(pose.rotation * (positions[i] - centre_));
}

void RigidFrame::advance(double dt, RigidPose &pose, RigidVelocity &motion) const {
  pose.centre += dt * motion.velocity;
  if (motion.spin.isZero(0.0)) return;
  const Mat3 axes = pose.rotation * axes_;
  const Vec3 before = axes.transpose() * motion.spin;   // in principal axes
  const Vec3 momentum = moments_.cwiseProduct(before);  // kg m²/s
  Vec3 mean = before;                                   // rad/s, of the step
  Mat3 turn = rotationBy(dt * mean);
  for (int k = 0; k < kMaxIterations; ++k) {
    const Vec3 next = 0.5 * (before + (turn.transpose() * momentum).cwiseQuotient(moments_));
    const double change = (next - mean).norm();
    mean = next;
    turn = rotationBy(dt * mean);
    if (!(change > 1e-15 * mean.norm())) break;
  }
  pose.rotation = axes * turn * axes_.transpose();
  motion.spin = axes * (turn * (turn.transpose() * momentum).cwiseQuotient(moments_));
}

RigidParticles RigidFrame::particles(const RigidPose &pose, Index first) const {
  RigidParticles out;
  out.first = first;
  out.mass = mass_;
  const Mat3 axes = pose.rotation * axes_;
  for (std::size_t k = 0; k < 4; ++k) out.arms[k] = axes * extents_.cwiseProduct(cornerOf(k));
  out.inverseInertia = inverseInertia(pose);
  return out;
}

std::array<Vec3, 4> RigidFrame::displacementsOf(const RigidPose &pose) const {
  const Mat3 turn = (pose.rotation - Mat3::Identity()) * axes_;
  std::array<Vec3, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = pose.centre - centre_ + turn * extents_.cwiseProduct(cornerOf(k));
  return out;
}

std::array<Vec3, 4> RigidFrame::particleVelocities(const RigidPose &pose, const RigidVelocity &motion) const {
  const Mat3 axes = pose.rotation * axes_;
  std::array<Vec3, 4> out;
  for (std::size_t k = 0; k < 4; ++k)
    out[k] = motion.velocity + motion.spin.cross(axes * extents_.cwiseProduct(cornerOf(k)));
  return out;
}

RigidVelocity RigidFrame::velocityOf(const RigidPose &pose, std::span<const Vec3> four) const {
  RigidVelocity motion;
  motion.velocity = 0.25 * (four[0] + four[1] + four[2] + four[3]);
  const RigidParticles own = particles(pose, 0);
  Vec3 moment = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k) moment += own.arms[k].cross(four[k] - motion.velocity);
  motion.spin = own.inverseInertia * (0.25 * mass_ * moment);
  return motion;
}

}  // namespace pointbased::detail
