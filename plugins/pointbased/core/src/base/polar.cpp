// SPDX-License-Identifier: Apache-2.0
#include "base/polar.h"

#include <Eigen/SVD>

namespace pointbased::detail {

Polar polarBySvd(const Mat3 &F) {
  if (!F.allFinite()) return {Mat3::Constant(std::nan("")), std::nan("")};
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 R = svd.matrixU() * svd.matrixV().transpose();
  if (R.determinant() < 0.0) {
    // A mirrored state turns the smallest stretch negative instead of the rotation improper. Where several are the
    // smallest round-off must not choose among them, else every point of a mirrored body turns its own way and it rests
    // folded.
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
