// SPDX-License-Identifier: Apache-2.0
// Shared by rereferencing of clouds and of lattices. Private to the core.
#pragma once

#include "rereferencing/rereferencing.h"

namespace pointbased::detail {

/// Fe = V R of a point; flat: det Fe is almost 0 or negative, and both factors are the identity.
struct ElasticPolar {
  Mat3 R = Mat3::Identity(), V = Mat3::Identity();
  bool flat = true;
};
[[nodiscard]] ElasticPolar elasticPolar(const Body &body, std::size_t q);

/// Rotates the history into the frame in which Fe = V.
inline void turn(const Mat3 &R, PronyPoint &point) {
  point.previous = R * point.previous * R.transpose();
  for (Mat3 &Q : point.internal) Q = R * Q * R.transpose();
}

/// Current surface, in the frame of the phyxels.
struct PresentSkin {
  Surface surface;
  std::vector<Vec3> normals;
};
[[nodiscard]] PresentSkin presentSkin(const Body &body, const ParallelFor &parallelFor);

[[nodiscard]] Result<Rereferencing> renewedLattice(const Body &body, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
