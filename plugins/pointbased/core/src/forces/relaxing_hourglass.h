// SPDX-License-Identifier: Apache-2.0
// Linear viscoelasticity of the modes of a lattice cell. Private to the core.
#pragma once

#include "forces/entry_forces.h"
#include "pointbased/constitution.h"

namespace pointbased::detail {

/// Hourglass energy if the shear modulus relaxes and the bulk modulus K = λ + 2/3 μ does not.
///
/// In plane stress across each lattice axis z, with dev e of E_xx, E_yy and the E_zz that leaves σ_zz = 0:
///
///     σ = K tr(e) I + 2 μ (dev e - β),   β = Σ_k β_k,   dβ_k/dt = (g_k dev e - β_k)/τ_k
///
/// A step of pronyStep() results in β = h + f dev e, h from the past: an elastic law with μ' = (1 - f) μ and the same
/// K, minus 2 μ h. After elimination of E_zz
///
///     D = D(μ', λ*') : e - D(μ, 2 μ λ'/(λ' + 2 μ')) : h
///
/// Shears and a_xyz relax like μ. Unlike in HourglassEnergy, a_xyz is rotated back by F as well, ½ s |F^T a_xyz|². This
/// is the same if F is a rotation, and as linear in its own strain as the rest, so that no closed loop generates
/// energy.
///
/// The history has the layout of B: it stores the deviator at E_xx, E_yy, and the shears at the shears.
class RelaxingHourglass {
 public:
  /// @param fresh  f: PronyStep::freshSum, or 0 if β at the end of the step is passed as the past
  RelaxingHourglass(const Material &material, double stabilisation, double fresh)
      : RelaxingHourglass(stabilisation, HourglassEnergy(material, stabilisation).twistModulus(), material.mu(),
                          material.lambda() + material.volumeStiffness, fresh) {}

  /// D, 3x4: of B and of Q^T F^T a_xyz.
  [[nodiscard]] HourglassStrain conjugate(const HourglassStrain &strain, const HourglassStrain &past, double volume,
                                          const Vec3 &variances) const {
    return applied(present_, strain, volume, variances) - applied(past_, past, volume, variances);
  }
  /// Same for a past of zero, and for changes: dD of de.
  [[nodiscard]] HourglassStrain conjugate(const HourglassStrain &strain, double volume, const Vec3 &variances) const {
    return applied(present_, strain, volume, variances);
  }
  /// Has the moduli of dD.
  [[nodiscard]] const HourglassEnergy &present() const { return present_; }

  /// E_zz = -acrossOfPast (h_xx + h_yy) - acrossOfSum (E_xx + E_yy)
  [[nodiscard]] double acrossOfPast() const { return acrossOfPast_; }
  [[nodiscard]] double acrossOfSum() const { return acrossOfSum_; }

  /// dev e in plane stress.
  [[nodiscard]] HourglassStrain deviator(const HourglassStrain &strain, const HourglassStrain &past) const {
    HourglassStrain out = strain;
    const auto normal = [&](int i, int a, int j, int b) {
      const double sum = strain(i, a) + strain(j, b);
      const double across = -acrossOfPast_ * (past(i, a) + past(j, b)) - acrossOfSum_ * sum;
      const double mean = (sum + across) / 3.0;
      out(i, a) -= mean;
      out(j, b) -= mean;
    };
    normal(1, 0, 2, 1);
    normal(0, 0, 2, 2);
    normal(0, 1, 1, 2);
    return out;
  }

 private:
  RelaxingHourglass(double scale, double twist, double mu, double lambda, double fresh)
      : RelaxingHourglass(scale, twist, mu, lambda + 2.0 / 3.0 * fresh * mu, (1.0 - fresh) * mu, fresh) {}
  RelaxingHourglass(double scale, double twist, double mu, double lambda1, double mu1, double fresh)
      : acrossOfPast_(2.0 * mu / (lambda1 + 2.0 * mu1)), acrossOfSum_(lambda1 / (lambda1 + 2.0 * mu1)),
        present_(scale * mu1, scale * 2.0 * mu1 * acrossOfSum_, (1.0 - fresh) * twist),
        past_(scale * mu, scale * 2.0 * mu * acrossOfSum_, twist) {}

  static HourglassStrain applied(const HourglassEnergy &energy, const HourglassStrain &strain, double volume,
                                 const Vec3 &variances) {
    HourglassStrain D;
    D.leftCols<3>() = energy.conjugate(strain.leftCols<3>(), volume * variances);
    D.col(3) = energy.twist(volume, variances) * strain.col(3);
    return D;
  }

  double acrossOfPast_, acrossOfSum_;
  HourglassEnergy present_, past_;
};

/// h: the remaining past at the end of a step without further strain.
inline HourglassStrain pastOf(const PronyStep &step, const HourglassHistory &memory) {
  return step.keep[0] * memory.relaxed[0] + step.keep[1] * memory.relaxed[1] +
         (step.old[0] + step.old[1]) * memory.previous;
}

/// History at the end of a step; `before` and `after` may be the same.
inline void advance(const RelaxingHourglass &modes, const PronyStep &step, const HourglassStrain &strain,
                    const HourglassHistory &before, HourglassHistory &after) {
  const HourglassStrain deviator = modes.deviator(strain, pastOf(step, before));
  for (std::size_t k = 0; k < 2; ++k)
    after.relaxed[k] = step.keep[k] * before.relaxed[k] + step.fresh[k] * deviator + step.old[k] * before.previous;
  after.previous = deviator;
}

/// Relaxing modes of one point at its current amplitudes and F.
struct RelaxingHourglassPoint {
  HourglassStrain A;       ///< (a_xy, a_xz, a_yz, a_xyz)
  Mat3 FQ;                 ///< F Q; Q for the linear law
  HourglassStrain strain;  ///< Q^T F^T A
  HourglassStrain D, QD;   ///< conjugate, and rotated into the frame of X

  RelaxingHourglassPoint(const StencilSet &s, const Mat3 &F, const Amplitudes &all)
      : A(all.topRows<3>()), FQ(F * s.axes), strain(FQ.transpose() * A) {}
  RelaxingHourglassPoint(const RelaxingHourglass &modes, const StencilSet &s, std::size_t q, const Mat3 &F,
                         const Amplitudes &all, const HourglassStrain &past)
      : RelaxingHourglassPoint(s, F, all) {
    D = modes.conjugate(strain, past, s.volumes[q], s.variances[q]);
    QD = s.axes * D;
  }
};

}  // namespace pointbased::detail
