// SPDX-License-Identifier: Apache-2.0
#include "polar.h"

#include <Eigen/SVD>

namespace pointbased::detail {

Polar polarBySvd(const Mat3 &F) {
  if (!F.allFinite()) return {Mat3::Constant(std::nan("")), std::nan("")};
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  // A mirrored state turns the smallest stretch negative instead of the rotation improper.
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) = -U.col(2);
  const Mat3 R = U * svd.matrixV().transpose();
  return {R, R.cwiseProduct(F).sum()};
}

}  // namespace pointbased::detail
