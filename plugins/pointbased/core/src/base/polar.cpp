// SPDX-License-Identifier: Apache-2.0
#include "base/polar.h"

#include <Eigen/SVD>

namespace pointbased::detail {

Polar polarBySvd(const Mat3 &F) {
  if (!F.allFinite()) return {Mat3::Constant(std::nan("")), std::nan("")};
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 R = svd.matrixU() * svd.matrixV().transpose();
  if (R.determinant() < 0.0) {
    // For a mirrored state the smallest stretch becomes negative instead of the rotation improper. Among several equal
    // smallest stretches round-off must not decide. Otherwise every point of a mirrored body would rotate differently
    // and the body would come to rest folded.
    const Vec3 preferred(0.36, 0.48, 0.8);
    const Vec3 &stretch = svd.singularValues();
    Vec3 turned = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (stretch[k] <= stretch[2] * (1.0 + 1e-12))
        turned += svd.matrixV().col(k).dot(preferred) * svd.matrixV().col(k);
    turned = turned.norm() > 1e-3 ? turned.normalized() : Vec3(svd.matrixV().col(2));
    R -= 2.0 * (R * turned) * turned.transpose();
  }
  return {R, R.cwiseProduct(F).sum()};
}

}  // namespace pointbased::detail
