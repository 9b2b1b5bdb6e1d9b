// SPDX-License-Identifier: Apache-2.0
#include "discretisation/moment.h"

#include "base/symmetric_eigen.h"

namespace pointbased::detail {

MomentInverse invertMoment(const Mat3 &A) {
  MomentInverse out;
  const auto [values, vectors] = symmetricEigen(A);
  const double largest = values[2];
  if (!(largest > 0.0)) return out;
  for (int k = 2; k >= 0; --k) {
    if (values[k] < kMomentCutOff * largest) break;
    const Vec3 e = vectors.col(k);
    out.inverse += e * e.transpose() / values[k];
    out.frame.col(out.rank++) = e;
  }
  if (out.rank == 2) out.frame.col(2) = out.frame.col(0).cross(out.frame.col(1));
  if (out.rank == 1) {
    out.frame.col(1) = out.frame.col(0).unitOrthogonal();
    out.frame.col(2) = out.frame.col(0).cross(out.frame.col(1));
  }
  return out;
}

}  // namespace pointbased::detail
