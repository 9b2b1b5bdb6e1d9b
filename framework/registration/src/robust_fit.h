// SPDX-License-Identifier: Apache-2.0
// Private to registration: the refinement of one motion.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "c3de/registration/rigid_registration.h"
#include "target_surface.h"

namespace c3de::registration {

/// Points to move onto a surface. Normals are empty or one per point.
struct MovingPoints {
  std::vector<Vec3> points, normals;
  bool areNormalsOriented = false;
  std::vector<LandmarkPair> pairs;
  double pairWeight = 0.0;  ///< points that one pair counts as

  [[nodiscard]] MovingPoints subset(std::span<const std::size_t> indices) const;
};

enum class Feet { near, exact };

/// The distance of each point to the surface after a motion to it; points without a foot within the limit, or with an
/// incompatible normal, have the limit.
[[nodiscard]] std::vector<double> distancesOf(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m,
                                              double limit_mm, Feet feet);

/// Mean of min(distance, limit)^2 over points and pairs, mm².
[[nodiscard]] double truncatedCost(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m,
                                   double limit_mm, Feet feet);

/// Standard deviation of the inliers: the smallest one from `noise_mm` upwards that is that of the distances below three
/// times itself.
[[nodiscard]] double robustDeviation(std::vector<double> distances, double noise_mm);

/// Iterates closest points with Tukey's weights whose limit falls from `limit_mm` to three robust deviations.
/// @param m  start: measured to body
[[nodiscard]] Mat4 refine(const TargetSurface &target, const MovingPoints &moving, Mat4 m, double limit_mm,
                          double noise_mm, int iterations, Feet feet);

/// The information of points and pairs about a motion: the matrix of the normal equations for a rotation about `centre`
/// (first three, in mm at the distance `arm`) and a translation, with unit weights of inliers.
[[nodiscard]] std::array<std::array<double, 6>, 6> information(const TargetSurface &target, const MovingPoints &moving,
                                                               const Mat4 &m, double limit_mm, const Vec3 &centre,
                                                               double arm);

}  // namespace c3de::registration
