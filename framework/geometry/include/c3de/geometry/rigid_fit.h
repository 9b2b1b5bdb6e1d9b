// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::geometry {

/// A rigid motion x -> R (x - centre) + centre + translation, as a person enters it. R = Rz Ry Rx: the rotation about x
/// is applied first. Angles in degrees, lengths in mm.
struct RigidPose {
  Vec3 translation_mm{}, rotation_deg{}, centre_mm{};
  friend bool operator==(const RigidPose &, const RigidPose &) = default;
};

[[nodiscard]] bool isFinite(const RigidPose &pose);
/// The motion as a matrix. Angles of any size.
[[nodiscard]] Mat4 matrixOf(const RigidPose &pose);
/// The motion of a rigid matrix about a centre, with angles from -180 to 180 degrees; that about y from -90 to 90. At
/// 90 degrees about y, where the others are not unique, the one about z is 0.
[[nodiscard]] RigidPose poseOf(const Mat4 &rigid, const Vec3 &centre_mm);
/// The inverse of a rigid matrix.
[[nodiscard]] Mat4 rigidInverse(const Mat4 &rigid);

/// The rigid motion that moves points closest to others.
struct RigidFit {
  Mat4 fixedFromMoving = kIdentity4;  ///< rotation with determinant 1, and translation
  std::vector<double> residual_mm;    ///< distance of each pair after the motion, in the order of the pairs
  double mean_mm = 0.0, rms_mm = 0.0, max_mm = 0.0;
};

/// Minimum number of pairs.
inline constexpr std::size_t kFewestRigidPairs = 3;
/// Points of which none is farther than this from a straight line, relative to their extent, do not define a rotation.
inline constexpr double kCollinear = 1e-3;

/// The rigid motion with the least sum of squared distances from the moved points to the fixed ones, by singular value
/// decomposition of their covariance (Kabsch 1976; Umeyama 1991, with unit scale). A reflection is never the result.
/// Any thread.
/// @param moving, fixed  pairs in the same order, mm
/// Errors (usage): different counts, fewer than three pairs, coordinates that are not finite, points of one of the sets
/// in a straight line or coincident.
[[nodiscard]] Expected<RigidFit> fitRigid(std::span<const Vec3> moving, std::span<const Vec3> fixed);

}  // namespace c3de::geometry
