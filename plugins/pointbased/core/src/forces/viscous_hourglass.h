// SPDX-License-Identifier: Apache-2.0
// Viscosity of the modes of a lattice cell. Private to the core.
#pragma once

#include "forces/quadratic_energy.h"

namespace pointbased::detail {

/// Moduli of the dissipation of the modes, Pa s: those of HourglassEnergy times 2 η/(λ + 2 μ), the retardation time of
/// a pressure wave. Half of the dissipated power is HourglassEnergy of the rates dB/dt and d(Q^T F^T a_xyz)/dt with
/// these moduli. Rates of B are strain rates: a rigid motion has none.
///
/// With this time the step bound of Body::stableStepFor() holds for the modes as well. The retardation time of a shear,
/// η/μ, is 5.5 times as long at ν = 0.45 and made the explicit steps of a crushed tube unstable.
[[nodiscard]] inline HourglassEnergy viscousHourglass(const Material &material, double stabilisation) {
  const HourglassEnergy elastic(material, stabilisation);
  const double retardation = 2.0 * material.viscosity / material.waveModulus();
  return {retardation * elastic.mu(), retardation * elastic.lambda(), retardation * elastic.twistModulus()};
}

/// Adds the viscous part to v P and to the conjugates of the modes and of xyz (ModalConjugates).
/// @param F  identity for the linear law
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

/// addViscousModes() of a cell with functions of second order, by QuadraticEnergy.
/// @param pull  conjugates of the second derivatives
inline void addViscousSecond(const HourglassEnergy &viscous, bool linear, const StencilSet &s, std::size_t q,
                             const QuadraticPoint &point, const Mat3 &F, const Amplitudes &modes, const Mat3 &rateOfF,
                             const SecondGradient &rateOfSecond, const Amplitudes &rateOfModes, Mat3 &stress,
                             SecondGradient &pull, Vec3 &twisted) {
  const Mat3 FQ = F * s.axes, rateOfFQ = linear ? Mat3(Mat3::Zero()) : Mat3(rateOfF * s.axes);
  const Vec3 twist = modes.topRightCorner<3, 1>();
  const SecondGradient D =
      QuadraticEnergy(viscous).conjugate(FQ.transpose() * rateOfSecond + rateOfFQ.transpose() * point.H, point.vC);
  const Vec3 d = viscous.twist(s.volumes[q], s.variances[q]) *
                 (FQ.transpose() * rateOfModes.topRightCorner<3, 1>() + rateOfFQ.transpose() * twist);
  pull += FQ * D;
  twisted += FQ * d;
  if (!linear) stress += point.H * (s.axes * D).transpose() + twist * (s.axes * d).transpose();
}

/// Mean gradient and amplitudes of a vector field over the corners of a cell.
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
