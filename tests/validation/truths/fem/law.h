// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

namespace truth {

enum class LawKind {
  linear,           ///< small strain: P = lambda tr(e) I + 2 mu e
  stvk,             ///< W = lambda/2 tr(E)^2 + mu E:E, E the Green strain
  corotated,        ///< W = mu |S - I|^2 + lambda/2 tr(S - I)^2, F = R S
  neoHookean,       ///< W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/2 (ln J)^2
  neoHookeanMixed,  ///< the same, with ln J projected onto linear functions in each element: for nu near 0.5
  isochoric         ///< W = mu/2 (J^(-2/3) tr(F^T F) - 3) + kappa/2 (J - 1)^2: CalculiX's NEO HOOKE, for comparison
};

struct Law {
  LawKind kind = LawKind::stvk;
  double lambda = 0.0;   ///< Pa
  double mu = 0.0;       ///< Pa
  double density = 0.0;  ///< kg/m^3
};

using Mat3 = Eigen::Matrix3d;
using Mat9 = Eigen::Matrix<double, 9, 9>;

/// First Piola stress and its derivative at one point.
struct StressPoint {
  Mat3 stress;   ///< P, Pa; row = component of x, column = component of X
  Mat9 tangent;  ///< dP_iJ/dF_kL at (3 i + J, 3 k + L), Pa
  bool valid;    ///< false where the law is not defined (J <= 0)
};

/// Law named `name` from Young's modulus (Pa) and Poisson's ratio. @errors throws std::runtime_error for an unknown
/// name
Law makeLaw(const std::string &name, double youngsModulus, double poissonRatio, double density);

/// The data that neoHookeanMixed receives from its element; the other laws ignore it.
struct MixedPressure {
  double stress = 0.0;   ///< projected lambda ln J, for P, Pa
  double tangent = 0.0;  ///< Newton's own prediction of it, for dP/dF, Pa
};

StressPoint evaluate(const Law &law, const Mat3 &F, const MixedPressure &pressure);

}  // namespace truth
