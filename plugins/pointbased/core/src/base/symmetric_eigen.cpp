// SPDX-License-Identifier: Apache-2.0
#include "base/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace pointbased::detail {

SymmetricEigen symmetricEigen(const Mat3 &A) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vec3 symmetricEigenvalues(const Mat3 &A) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace pointbased::detail
