// SPDX-License-Identifier: Apache-2.0
// Hourglass energy: stabilises the four modes of a lattice cell that a single evaluation point cannot detect. Private
// to the core.
#pragma once

#include "pointbased/material.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// Fraction of E in the energy of the mode xyz. From 0.3 on the lowest modes of a free cube of six layers are those of
/// the continuum; with 0.1, cells oscillate at lower frequencies. Bonded cubes and indentations are not affected.
inline constexpr double kTwistStiffness = 0.3;

/// Fraction of the shear of a twisted cell that remains after warping. With 0.42 the torque of a square bar of 3, 5 and
/// 8 cells across is correct to some tenths of a per cent.
inline constexpr double kWarping = 0.42;

/// Energy of the strain that varies linearly within a cell, in plane stress:
///
///     a_m = Σ_j γ_mj u_j,   B = Q^T F^T (a_xy, a_xz, a_yz)
///     per lattice axis z with x, y across: E_xx = B_x,xz, E_yy = B_y,yz, 2 E_xy = B_y,xz + B_x,yz
///     U += κ v s_z (μ (E_xx² + E_yy²) + λ*/2 (E_xx + E_yy)²),   λ* = 2 λ μ / (λ + 2 μ)
///     U += κ v μ/2 (θ Σ t² + (1 - θ)/3 (Σ t)²),   t_z = √s_z 2 E_xy and so on,   θ = kWarping
///     U += κ v s² kTwistStiffness E/2 |a_xyz|²
///
/// The shears t of a torsion about any axis sum to zero. A twisted cell relieves about half of them by warping, which
/// its corners cannot represent. The sum of the t is bending of a rotated cell, which keeps its full stiffness.
///
/// Plane stress, because a cell with free neighbours contracts perpendicular to the plane: no locking as ν approaches
/// one half. F^T makes it invariant to rotation. For the linear law F = I, so that it remains linear.
class HourglassEnergy {
 public:
  HourglassEnergy(const Material &material, double stabilisation) : mu_(stabilisation * material.mu()) {
    const double lambda = material.lambda() + material.volumeStiffness;
    lambda_ = stabilisation * 2.0 * lambda * material.mu() / (lambda + 2.0 * material.mu());
    twist_ = stabilisation * kTwistStiffness * material.youngsModulus;
  }
  /// From moduli, Pa: μ, λ*, and the factor of |a_xyz|².
  HourglassEnergy(double mu, double lambda, double twist) : mu_(mu), lambda_(lambda), twist_(twist) {}

  [[nodiscard]] double mu() const { return mu_; }
  [[nodiscard]] double lambda() const { return lambda_; }
  [[nodiscard]] double twistModulus() const { return twist_; }

  /// dU/dB, linear in B. U = B : dU/dB / 2.
  /// @param vs  volume times variances, m⁵
  [[nodiscard]] Mat3 conjugate(const Mat3 &B, const Vec3 &vs) const {
    const Vec3 root = vs.cwiseSqrt();
    const Vec3 t = root.cwiseProduct(Vec3(B(2, 0) + B(1, 1), B(2, 0) + B(0, 2), B(1, 1) + B(0, 2)));
    const double common = (1.0 - kWarping) / 3.0 * t.sum();
    const double tx = mu_ * root[0] * (kWarping * t[0] + common);
    const double ty = mu_ * root[1] * (kWarping * t[1] + common);
    const double tz = mu_ * root[2] * (kWarping * t[2] + common);
    const double px = lambda_ * (B(1, 0) + B(2, 1));
    const double py = lambda_ * (B(0, 0) + B(2, 2));
    const double pz = lambda_ * (B(0, 1) + B(1, 2));
    const double two = 2.0 * mu_;
    Mat3 D;
    D << vs[1] * (two * B(0, 0) + py), vs[2] * (two * B(0, 1) + pz), ty + tz,  //
        vs[0] * (two * B(1, 0) + px), tx + tz, vs[2] * (two * B(1, 2) + pz),   //
        tx + ty, vs[0] * (two * B(2, 1) + px), vs[1] * (two * B(2, 2) + py);
    return D;
  }

  /// dU/da_xyz = twist * a_xyz
  [[nodiscard]] double twist(double volume, const Vec3 &variances) const {
    const double mean = variances.mean();
    return twist_ * volume * mean * mean;
  }

 private:
  double mu_, lambda_, twist_;
};

/// Four columns: a_xy, a_xz, a_yz, a_xyz. The fourth row is padding for vector registers.
using Amplitudes = Eigen::Matrix<double, 4, 4>;

inline Eigen::Vector4d padded(const Vec3 &v) { return {v[0], v[1], v[2], 0.0}; }

inline Amplitudes amplitudes(const StencilSet &s, std::size_t q, std::span<const Vec3> field) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Vec3 anchor = field[s.phyxels.indices[first]];
  const ModeRows modes(s, q);
  Amplitudes A = Amplitudes::Zero();
  for (Index e = first + 1; e < last; ++e) {
    const Eigen::Vector4d d = padded(field[s.phyxels.indices[e]] - anchor);
    const Eigen::Vector4d &row = modes[e];
    for (int m = 0; m < 4; ++m) A.col(m) += row[m] * d;
  }
  return A;
}

/// Hourglass energy of one point at its current amplitudes and F.
struct HourglassPoint {
  Mat3 A;      ///< (a_xy, a_xz, a_yz), 1/m
  Vec3 twist;  ///< a_xyz, 1/m²
  Mat3 FQ;     ///< F Q; Q for the linear law
  Vec3 vs;
  double twistStiffness;
  Mat3 D, QD;  ///< dU/dB, and rotated into the frame of X
  double energy;

  HourglassPoint(const HourglassEnergy &hourglass, const StencilSet &s, std::size_t q, const Mat3 &F,
                 const Amplitudes &all)
      : HourglassPoint(hourglass, s, q, F, all, s.variances[q]) {}
  HourglassPoint(const HourglassEnergy &hourglass, const StencilSet &s, std::size_t q, const Mat3 &F,
                 const Amplitudes &all, const Vec3 &variances)
      : A(all.topLeftCorner<3, 3>()), twist(all.topRightCorner<3, 1>()), FQ(F * s.axes), vs(s.volumes[q] * variances),
        twistStiffness(hourglass.twist(s.volumes[q], variances)) {
    const Mat3 B = FQ.transpose() * A;
    D = hourglass.conjugate(B, vs);
    QD = s.axes * D;
    energy = 0.5 * (B.cwiseProduct(D).sum() + twistStiffness * twist.squaredNorm());
  }
};

}  // namespace pointbased::detail
