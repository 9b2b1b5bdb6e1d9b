// SPDX-License-Identifier: Apache-2.0
// Viscosity of the modes of a lattice cell. Private to the core.
#pragma once

#include "forces/hourglass_energy.h"

namespace pointbased::detail {

/// Moduli of the dissipation of the modes, Pa s. Half of the power that is lost is HourglassEnergy of the rates dB/dt
/// and d(Q^T F^T a_xyz)/dt with
///
///     μ → η,   λ* → 2 η (λ/(λ + 2 μ))²,   E → E η/μ
///
/// which is 2 η |dE/dt|²/2 of the strain that varies linearly within the cell, E_zz as plane stress leaves it; a_xyz has
/// the retardation time η/μ of a shear. Rates of B are those of a strain: a rigid motion has none.
[[nodiscard]] inline HourglassEnergy viscousHourglass(const Material &material, double stabilisation) {
  const double lambda = material.lambda() + material.volumeStiffness, eta = stabilisation * material.viscosity;
  const double across = lambda / (lambda + 2.0 * material.mu());
  return {eta, 2.0 * eta * across * across, kTwistStiffness * eta * material.youngsModulus / material.mu()};
}

/// Adds to v P, to what pulls the modes and to what pulls xyz (ModalConjugates) the viscous part.
/// @param F       identity for the linear law
/// @param rateOfF, rateOfModes  dF/dt and the amplitudes of the velocities
inline void addViscousModes(const HourglassEnergy &viscous, bool linear, const StencilSet &s, std::size_t q,
                            const Mat3 &F, const Amplitudes &modes, const Mat3 &rateOfF, const Amplitudes &rateOfModes,
                            Mat3 &stress, Mat3 &pull, Vec3 &twisted) {
  using Modes = Eigen::Matrix<double, 3, 4>;
  const Modes A = modes.topRows<3>(), dA = rateOfModes.topRows<3>();
  const Mat3 FQ = F * s.axes;
  Modes rate = FQ.transpose() * dA;
  if (!linear) rate += (rateOfF * s.axes).transpose() * A;
  Modes D;
  D.leftCols<3>() = viscous.conjugate(Mat3(rate.leftCols<3>()), s.volumes[q] * s.variances[q]);
  D.col(3) = viscous.twist(s.volumes[q], s.variances[q]) * rate.col(3);
  pull += FQ * D.leftCols<3>();
  twisted += FQ * D.col(3);
  if (!linear) stress += A * (s.axes * D).transpose();
}

/// Mean gradient and amplitudes of a field of vectors over the corners of a cell.
inline void fittedModes(const StencilSet &s, std::size_t q, std::span<const Vec3> field, Mat3 &gradient,
                        Amplitudes &modes) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Vec3 anchor = field[s.phyxels.indices[first]];
  const GradientRows gradientRows(s, q);
  const ModeRows modeRows(s, q);
  Eigen::Matrix<double, 4, 7> all = Eigen::Matrix<double, 4, 7>::Zero();
  for (Index e = first + 1; e < last; ++e) {
    const Eigen::Vector4d d = padded(field[s.phyxels.indices[e]] - anchor);
    for (int c = 0; c < 3; ++c) all.col(c) += gradientRows[e][c] * d;
    for (int m = 0; m < 4; ++m) all.col(3 + m) += modeRows[e][m] * d;
  }
  gradient = all.topLeftCorner<3, 3>();
  modes = all.rightCols<4>();
}

}  // namespace pointbased::detail
