// SPDX-License-Identifier: Apache-2.0
// Energy of the strain that varies linearly within a cell with functions of second order. Private to the core.
#pragma once

#include "forces/hourglass_energy.h"
#include "pointbased/engine.h"

namespace pointbased::detail {

/// Second derivatives, lattice axes: columns xx, yy, zz, xy, xz, yz, 1/m.
using SecondGradient = Eigen::Matrix<double, 3, 6>;

/// Energy of the strain E + Σ_a E_a (x - x̄)_a of a part with the covariance C of its material:
///
///     H_ab = mean of ∂²u/∂x_a∂x_b over the part,   B_ab = Q^T F^T H_ab
///     (E_a)_ij = ((B_ja)_i + (B_ia)_j)/2
///     U = v/2 Σ_ab C_ab (2 μ E_a : E_b + λ* tr E_a tr E_b),   λ* = 2 λ μ/(λ + 2 μ)
///
/// Nothing in it is fitted: the functions contain the warping of a twisted section. λ* because the quadratic functions
/// have no freedom of their own to contract; λ would lock as ν approaches one half. A stabilisation of
/// kLatticeStabilisation is this energy itself, other values scale it. The mode xyz keeps that of HourglassEnergy.
class QuadraticEnergy {
 public:
  explicit QuadraticEnergy(const HourglassEnergy &modes)
      : mu_(modes.mu() / kLatticeStabilisation), lambda_(modes.lambda() / kLatticeStabilisation) {}

  /// dU/dB, linear in B. U = B : dU/dB / 2.
  /// @param vC  volume times covariance, m⁵
  [[nodiscard]] SecondGradient conjugate(const SecondGradient &B, const Mat3 &vC) const {
    std::array<Mat3, 3> slopes;
    for (int a = 0; a < 3; ++a) {
      Mat3 &E = slopes[static_cast<std::size_t>(a)];
      for (int j = 0; j < 3; ++j) E.col(j) = B.col(column(j, a));
      E = Mat3(0.5 * (E + E.transpose()));
    }
    SecondGradient D = SecondGradient::Zero();
    for (int a = 0; a < 3; ++a) {
      const Mat3 mean = vC(a, 0) * slopes[0] + vC(a, 1) * slopes[1] + vC(a, 2) * slopes[2];
      Mat3 stress = 2.0 * mu_ * mean;
      stress.diagonal().array() += lambda_ * mean.trace();
      for (int j = 0; j < 3; ++j) D.col(column(j, a)) += stress.col(j);
    }
    return D;
  }

  /// Column of SecondGradient.
  static constexpr int column(int a, int b) { return a == b ? a : a + b + 2; }

 private:
  double mu_, lambda_;
};

/// xx, yy, zz of a field, 1/m² times its unit.
inline Mat3 bendsOf(const StencilSet &s, std::size_t q, const QuadraticPoints::Point &point,
                    std::span<const Vec3> field) {
  const Index first = s.phyxels.offsets[q], count = s.phyxels.offsets[q + 1] - first;
  const Vec3 anchor = field[s.phyxels.indices[first]];
  const Vec3 *rows = s.quadratic.bends.data() + point.first;
  Mat3 out = Mat3::Zero();
  for (Index k = 1; k < count; ++k) out += (field[s.phyxels.indices[first + k]] - anchor) * rows[k].transpose();
  return out;
}

inline SecondGradient secondGradient(const Mat3 &bends, const Amplitudes &modes) {
  SecondGradient out;
  out << bends, modes.topLeftCorner<3, 3>();
  return out;
}

/// The energy of one point at its current second derivatives and F.
struct QuadraticPoint {
  SecondGradient H;
  Mat3 FQ;  ///< F Q; Q for the linear law
  Mat3 vC;
  SecondGradient D, QD;  ///< dU/dB, and rotated into the frame of X
  double energy;

  QuadraticPoint(const QuadraticEnergy &law, const StencilSet &s, std::size_t q, const QuadraticPoints::Point &point,
                 const Mat3 &F, const SecondGradient &second)
      : H(second), FQ(F * s.axes), vC(s.volumes[q] * point.covariance) {
    const SecondGradient B = FQ.transpose() * H;
    D = law.conjugate(B, vC);
    QD = s.axes * D;
    energy = 0.5 * B.cwiseProduct(D).sum();
  }

  /// Change of dU/dB.
  [[nodiscard]] SecondGradient conjugateChange(const QuadraticEnergy &law, const StencilSet &s, bool linear,
                                               const Mat3 &dF, const SecondGradient &dH) const {
    SecondGradient dB = FQ.transpose() * dH;
    if (!linear) dB += (dF * s.axes).transpose() * H;
    return law.conjugate(dB, vC);
  }
};

/// Adds the forces by the conjugates of xx, yy, zz; to be called after spread().
inline void spreadBends(const StencilSet &s, std::size_t q, const QuadraticPoints::Point &point, const Mat3 &pull,
                        std::span<Vec3> entries) {
  const Index first = s.phyxels.offsets[q], count = s.phyxels.offsets[q + 1] - first;
  const Vec3 *rows = s.quadratic.bends.data() + point.first;
  Vec3 sum = Vec3::Zero();
  for (Index k = 1; k < count; ++k) {
    const Vec3 f = pull * rows[k];
    entries[first + k] -= f;
    sum += f;
  }
  entries[first] += sum;
}

}  // namespace pointbased::detail
