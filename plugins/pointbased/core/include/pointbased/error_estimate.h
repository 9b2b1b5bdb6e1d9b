// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace pointbased {

/// Recovery smooths what is sharp (the edges of a clamp), so it sees less than the whole error; strains of a cloud next
/// to its surface are one-sided besides. With these factors the estimate is 0.9 … 1.2 times the true error on most
/// bodies, 0.5 … 1.3 on all that were measured: bending, twist, bonded compression, indentation and a half ball at
/// 3 … 10 layers, lattice aligned, offset and turned, and clouds (bench_error). The lowest is a punch of two spacings.
inline constexpr double kLatticeErrorFactor = 1.25;
inline constexpr double kCloudErrorFactor = 1.4;

/// Strains below this are round-off: a body that is only moved has no error.
inline constexpr double kStrainFloor = 1e-9;

/// How far a body's present strains are from those of infinitely many phyxels, as far as the body itself can tell.
struct ErrorEstimate {
  /// 0 … 1: energy norm of the strains' error over that of the strains. Strains and stresses are off by about this part
  /// in the mean, energies, mean displacements and reactions by about its square.
  double relative = 0.0;
  /// 0 … 1: part of the elastic energy that sits in the modes one evaluation per point cannot see.
  double stabilisationShare = 0.0;
};

/// Memory of estimateError(), so that it allocates nothing when called again.
struct ErrorScratch {
  using Strain = Eigen::Matrix<double, 6, 1>;  ///< xx, yy, zz, yz, xz, xy in the axes of the lattice
  using Slopes = Eigen::Matrix<double, 6, 3>;  ///< a strain's derivatives along these axes, 1/m
  /// Moments of evaluation points, by volume, and of their strains.
  struct Moments {
    double volume = 0.0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    Strain strain = Strain::Zero();
    Slopes strainFirst = Slopes::Zero();
  };
  std::vector<Strain> strains;            ///< [points]
  std::vector<Vec3> centres;              ///< [points] in the axes of the lattice, m
  std::vector<Moments> moments;           ///< [phyxels] about each, of the points around it; lattices only
  std::vector<double> errors;             ///< [points] J
  std::vector<Eigen::Vector2d> energies;  ///< [points] strain, stabilisation, J
};

/// Estimates the error of a body's strains by recovery, in the manner of Zienkiewicz and Zhu.
///
/// Around each point q an affine strain E* + G* (X - X_q) is fitted to the strains of the points around, by volume; on
/// a lattice they count by how many phyxels they share with q, in a cloud the neighbours count alike. What q itself
/// says is E_q + G_q (X - X_q): G_q from the modes of its cell, linear in plane stress; 0 in a cloud. With C the moduli
/// at rest and s_a the variances of q's material along the axes (v^(2/3)/12 in a cloud):
///
///     η_q² = v_q [½ (E* - E_q) : C : (E* - E_q) + Σ_a s_a ½ (G*_a - G_qa) : C : (G*_a - G_qa)]
///     relative² = c² Σ η² / (U + c² Σ η²)
///
/// U: elastic energy with its stabilisation; c: kLatticeErrorFactor or kCloudErrorFactor. ½ ΔE : C : ΔE is the same as
/// ½ ΔS : C^-1 : ΔS. E: Green strain of the elastic part of F; small strain with the linear law. Only points of one
/// material are compared. Where no points lie beside each other (a single layer) a slope is not known and not counted;
/// flat stencils count nothing. Affine states and rigid motions have no error. Errors that are smooth are not seen: a
/// support at the wrong place, a wrong material.
///
/// Uses gradients() and displacements as they are, so of the last evaluation. Costs about three force
/// evaluations on a lattice, two in a cloud.
/// @param perPhyxel  null, or [phyxels] out, for colours: sqrt(c² η²/v / ((U + c² Σ η²)/V)), the error's density over
///                   the body's mean energy density. The root of its mean square by volume is `relative`
/// @return  finite whatever the state is; 1 and 1 where it is not finite itself
/// @threads one at a time per scratch; the same bits for any number of threads behind parallelFor
/// @source  Zienkiewicz and Zhu, The superconvergent patch recovery and a posteriori error estimates, IJNME 33, 1992;
///          slopes against the modes of a cell: own
[[nodiscard]] ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel, ErrorScratch &scratch,
                                          const ParallelFor &parallelFor);
/// The same with memory of its own.
[[nodiscard]] ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel = nullptr);

/// Part of the stabilisation in the elastic energy around each phyxel, 0 … 1: above 0.05 the strain there changes more
/// from cell to cell than these can follow.
/// @param scratch    as the last estimateError() of this body left it
/// @param perPhyxel  [phyxels] out
void stabilisationShares(const Body &body, const ErrorScratch &scratch, std::vector<double> &perPhyxel);

}  // namespace pointbased
