// SPDX-License-Identifier: Apache-2.0
// Polar decomposition, and bounds of eigenvalues without decomposition. Private to the core.
#pragma once

#include <algorithm>
#include <cmath>

#include "pointbased/types.h"

namespace pointbased::detail {

inline Mat3 cofactor(const Mat3 &F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

/// d/ds cof(F + s dF) at s = 0
inline Mat3 cofactorDifferential(const Mat3 &F, const Mat3 &dF) {
  Mat3 c;
  c.col(0) = dF.col(1).cross(F.col(2)) + F.col(1).cross(dF.col(2));
  c.col(1) = dF.col(2).cross(F.col(0)) + F.col(2).cross(dF.col(0));
  c.col(2) = dF.col(0).cross(F.col(1)) + F.col(0).cross(dF.col(1));
  return c;
}

struct Polar {
  Mat3 R;        ///< proper rotation with the largest tr(R^T F)
  double trace;  ///< tr(R^T F): sum of the singular values, the smallest with the sign of det F
};

/// Singular value decomposition: for any finite F, including those with ambiguous R. Takes some hundred ns.
Polar polarBySvd(const Mat3 &F);

/// R of F = R U, robust for det F <= 0.
///
/// t = tr(R^T F) is the largest root of t⁴ - 2 |F|² t² - 8 det F t + |F|⁴ - 4 |cof F|², the characteristic polynomial
/// of Horn's quaternion matrix. All roots are real, so Laguerre's method converges to it monotonically from sqrt(3)
/// |F|, which is exact for a scaled rotation. Since dt = R : dF, R is the derivative of that root. If two roots
/// coincide, the singular value decomposition is used. An F of less than a billionth is round-off without direction and
/// returns R = 1 everywhere. A body that has collapsed to a point then opens as a whole, without folds.
/// @source  Horn, Closed-form solution of absolute orientation using unit quaternions, JOSA A 4, 1987; derivative: own
inline Polar polar(const Mat3 &F) {
  const Mat3 c = cofactor(F);
  const double a = F.squaredNorm();
  const double b = F.col(0).dot(c.col(0));
  if (a < 1e-18) return {Mat3::Identity(), F.trace()};
  const double constant = a * a - 4.0 * c.squaredNorm();
  double t = std::sqrt(3.0 * a);
  bool found = false;
  for (int k = 0; k < 8 && !found; ++k) {
    const double value = ((t * t - 2.0 * a) * t - 8.0 * b) * t + constant;
    const double p1 = 4.0 * ((t * t - a) * t - 2.0 * b);
    const double p2 = 12.0 * t * t - 4.0 * a;
    const double change = 4.0 * value / (p1 + std::sqrt(std::max(0.0, 9.0 * p1 * p1 - 12.0 * value * p2)));
    t -= change;
    found = std::abs(change) < 1e-6 * t;  // the next change is of the order of its cube
  }
  const double slope = (t * t - a) * t - 2.0 * b;  // 2 (s1 + s2)(s2 + s3)(s3 + s1)
  // NaN is passed to the decomposition, which returns NaN.
  if (!found || !(slope > 0.01 * t * t * t)) return polarBySvd(F);
  Mat3 R = ((t * t + a) * F + 2.0 * t * c - 2.0 * (F * (F.transpose() * F))) / slope;
  // One Newton-Schulz step removes residual stretch from round-off.
  R = 1.5 * R - 0.5 * (R * (R.transpose() * R));
  return {R, t};
}

/// Upper bound of the largest eigenvalue of a symmetric matrix, by Laguerre's method from infinity, which decreases
/// towards the largest root without passing it. The first step is the bound by mean and variance. A second step follows
/// where the first may be more than 5 % too large.
inline double largestEigenvalueBound(const Mat3 &m) {
  const double mean = m.trace() / 3.0;
  const double scatter = std::max(0.0, m.squaredNorm() - 3.0 * mean * mean);  // sum of (eigenvalue - mean)²
  const double x = std::sqrt(2.0 / 3.0 * scatter);
  const double slack = 1e-14 * std::abs(mean) + 1e-12 * x;  // round-off
  if (x <= 0.1 * std::abs(mean)) return mean + x + slack;
  // Characteristic polynomial of m - mean: x³ - scatter/2 x - determinant; its slope at x is scatter/2 · 3.
  Mat3 d = m;
  d.diagonal().array() -= mean;
  const double determinant = d.col(0).dot(d.col(1).cross(d.col(2)));
  const double p = (x * x - 0.5 * scatter) * x - determinant;
  if (!(p > 0.0)) return mean + x + slack;
  const double p1 = 1.5 * scatter;
  const double root = std::sqrt(std::max(0.0, 4.0 * p1 * p1 - 36.0 * p * x));
  return mean + x - 3.0 * p / (p1 + root) + slack;
}

}  // namespace pointbased::detail
