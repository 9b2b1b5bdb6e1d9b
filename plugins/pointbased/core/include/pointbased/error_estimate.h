// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace pointbased {

/// Recovery smooths sharp features (the edges of a clamp), so it detects less than the whole error. In addition, the
/// strains of a cloud next to its surface are one-sided. With these factors the estimate is 0.9 … 1.2 times the true
/// error on most bodies and 0.5 … 1.3 on all that were measured: bending, twist, bonded compression, indentation and a
/// half ball at 3 … 10 layers, lattice aligned, offset and turned, and clouds (bench_error). The lowest value is from a
/// punch of two spacings.
inline constexpr double kLatticeErrorFactor = 1.25;
inline constexpr double kCloudErrorFactor = 1.4;

/// Strains below this are round-off: a body in rigid motion has no error.
inline constexpr double kStrainFloor = 1e-9;

/// Estimated difference between the present strains of a body and the limit of infinitely many phyxels.
struct ErrorEstimate {
  /// 0 … 1: energy norm of the error of the strains over that of the strains. On average, strains and stresses have
  /// about this relative error; energies, mean displacements and reactions about its square.
  double relative = 0.0;
  /// 0 … 1: fraction of the elastic energy in the modes that one evaluation per point does not resolve.
  double stabilisationShare = 0.0;
};

/// Scratch storage of estimateError(), so that repeated calls do not allocate.
struct ErrorScratch {
  using Strain = Eigen::Matrix<double, 6, 1>;  ///< xx, yy, zz, yz, xz, xy in the axes of the lattice
  using Slopes = Eigen::Matrix<double, 6, 3>;  ///< a strain's derivatives along these axes, 1/m
  /// Volume-weighted moments of evaluation points and of their strains.
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

/// Estimates the error of a body's strains by recovery, after Zienkiewicz and Zhu.
///
/// Around each point q an affine strain E* + G* (X - X_q) is fitted, by volume, to the strains of the points around it.
/// On a lattice they are weighted by the number of phyxels they share with q; in a cloud all neighbours have equal
/// weight. The strain at q itself is E_q + G_q (X - X_q), with G_q from the modes of its cell, linear in plane stress;
/// 0 in a cloud. With C the moduli at rest and s_a the variances of q's material along the axes (v^(2/3)/12 in a
/// cloud):
///
///     η_q² = v_q [½ (E* - E_q) : C : (E* - E_q) + Σ_a s_a ½ (G*_a - G_qa) : C : (G*_a - G_qa)]
///     relative² = c² Σ η² / (U + c² Σ η²)
///
/// U: elastic energy including stabilisation; c: kLatticeErrorFactor or kCloudErrorFactor. ½ ΔE : C : ΔE equals ½ ΔS :
/// C^-1 : ΔS. E: Green strain of the elastic part of F; small strain with the linear law. Only points of the same
/// material are compared. Where no points are adjacent (a single layer), the slope is unknown and does not count; flat
/// stencils do not count. Affine states and rigid motions have no error. Smooth errors are not detected: a support at
/// the wrong position, a wrong material.
///
/// Uses gradients() and displacements as they are, thus of the last evaluation. Costs about three force evaluations on
/// a lattice, two in a cloud.
/// @param perPhyxel  null, or [phyxels] out, for colours: sqrt(c² η²/v / ((U + c² Σ η²)/V)), the error's density over
///                   the body's mean energy density. The root of its mean square by volume is `relative`
/// @return  finite for any state; 1 and 1 if the state itself is not finite
/// @threads one at a time per scratch; bitwise identical for any number of threads behind parallelFor
/// @source  Zienkiewicz and Zhu, The superconvergent patch recovery and a posteriori error estimates, IJNME 33, 1992;
///          slopes against the modes of a cell: own
[[nodiscard]] ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel, ErrorScratch &scratch,
                                          const ParallelFor &parallelFor);
/// Same, with temporary scratch storage.
[[nodiscard]] ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel = nullptr);

/// Fraction of the stabilisation in the elastic energy around each phyxel, 0 … 1. Above 0.05 the strain varies more
/// from cell to cell than the cells can represent.
/// @param scratch    as left by the last estimateError() of this body
/// @param perPhyxel  [phyxels] out
void stabilisationShares(const Body &body, const ErrorScratch &scratch, std::vector<double> &perPhyxel);

}  // namespace pointbased
