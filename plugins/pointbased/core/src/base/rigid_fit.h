// SPDX-License-Identifier: Apache-2.0
// The rigid motion between two sets of points. Private to the core.
#pragma once

#include "pointbased/types.h"

namespace pointbased::detail {

/// x = R (X - centre) + centre + shift: weighted least-squares rigid motion.
struct RigidFit {
  Mat3 rotation = Mat3::Identity();
  Vec3 centre = Vec3::Zero(), shift = Vec3::Zero();  ///< m
  [[nodiscard]] Vec3 operator()(const Vec3 &X) const { return rotation * (X - centre) + centre + shift; }
};
/// @source  Kabsch, A solution for the best rotation to relate two sets of vectors, Acta Cryst. A32, 1976
[[nodiscard]] RigidFit rigidFit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights);

}  // namespace pointbased::detail
