// SPDX-License-Identifier: Apache-2.0
// The inverse of a moment matrix in the directions that its points span. Private to the core.
#pragma once

#include <Eigen/Eigenvalues>

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased::detail {

/// Truncated inverse, its rank, and the frame of what is left: flat directions last.
struct MomentInverse {
  Mat3 inverse = Mat3::Zero();
  Mat3 frame = Mat3::Identity();
  int rank = 0;
};

/// By eigenvalues, without those below kMomentCutOff of the largest.
inline MomentInverse invertMoment(const Mat3 &A) {
  MomentInverse out;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(A);
  const Vec3 values = solver.eigenvalues();  // ascending
  const double largest = values[2];
  if (!(largest > 0.0)) return out;
  for (int k = 2; k >= 0; --k) {
    if (values[k] < kMomentCutOff * largest) break;
    const Vec3 e = solver.eigenvectors().col(k);
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
