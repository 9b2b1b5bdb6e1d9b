// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace reference {

/// What the published formulas get wrong, one switch each: true is as printed, false as it should be.
///
/// Equation numbers are those of the thesis. docs/theory lists the consequences.
struct Errata {
  bool factorFour;          ///< eps = J^T J - I, f_j = -2 v J sigma d_j: four times the energy of the modulus given
  bool printedStrain;       ///< (6.4): J J^T - I in place of J^T J - I: the force is not objective
  bool forwardEuler;        ///< (6.9): the position moves with the old velocity; else (6.10), velocity Verlet
  bool vanishingShell;      ///< support = distance of the N-th neighbour, where poly6 is zero; else beyond it
  bool absoluteCutOff;      ///< singular values of A below 1e-3, in whatever unit; else relative to the largest
  bool truncatedFit;        ///< flat directions of A are dropped and J left as it is; else J is completed by a rotation
  bool densityVolumes;      ///< m = s d³ rho, v = m/rho_i; else the given volumes, scaled to the volume of the body
  bool creepOfTotalStrain;  ///< plastic strain grows by a part of the total strain; else of the elastic strain
  bool creepPerStep;        ///< that part is the same for every step; else 1 - exp(-dt/tau)
  bool plasticVolume;       ///< plastic strain may change the volume; else its trace is taken out

  /// The thesis as printed.
  [[nodiscard]] static constexpr Errata literal() {
    return {true, true, true, true, true, true, true, true, true, true};
  }
  [[nodiscard]] static constexpr Errata corrected() { return {}; }
};

}  // namespace reference
