// SPDX-License-Identifier: Apache-2.0
// Inverse of a moment matrix in the directions that its points span. Private to the core.
#pragma once

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased::detail {

/// Truncated inverse, its rank, and the frame of its eigenvectors: flat directions last.
struct MomentInverse {
  Mat3 inverse = Mat3::Zero();
  Mat3 frame = Mat3::Identity();
  int rank = 0;
};

/// From eigenvalues, without those below kMomentCutOff of the largest.
MomentInverse invertMoment(const Mat3 &A);

}  // namespace pointbased::detail
