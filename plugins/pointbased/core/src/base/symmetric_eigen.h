// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of symmetric matrices, compiled once: Eigen's decompositions take seconds in every translation unit.
// Private to the core.
#pragma once

#include "pointbased/types.h"

namespace pointbased::detail {

/// A = V diag(values) Vᵀ
struct SymmetricEigen {
  Vec3 values;   ///< ascending
  Mat3 vectors;  ///< in columns, unit length

  /// V diag(d) Vᵀ
  [[nodiscard]] Mat3 with(const Vec3 &d) const { return vectors * d.asDiagonal() * vectors.transpose(); }
};

/// @param A  symmetric; its lower triangle is read
SymmetricEigen symmetricEigen(const Mat3 &A);

/// Ascending. Faster than symmetricEigen(), and equal up to rounding.
Vec3 symmetricEigenvalues(const Mat3 &A);

}  // namespace pointbased::detail
