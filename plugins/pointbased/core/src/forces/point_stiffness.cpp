// SPDX-License-Identifier: Apache-2.0
#include "forces/point_stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pointbased::detail {

Matrix9 positivePart(const Matrix9 &C) {
  const double shift = 1e-10 * C.trace();
  if (shift > 0.0 && Eigen::LLT<Matrix9>(C + shift * Matrix9::Identity()).info() == Eigen::Success) return C;
  const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(C);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace pointbased::detail
