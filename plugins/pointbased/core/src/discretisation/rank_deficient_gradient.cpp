// SPDX-License-Identifier: Apache-2.0
#include "discretisation/rank_deficient_gradient.h"

namespace pointbased::detail {

Mat3 shortestRotation(const Vec3 &from, const Vec3 &to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

}  // namespace pointbased::detail
