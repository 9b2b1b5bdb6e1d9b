// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model.h"

#include <vector>

namespace truth {

struct Solution {
  std::vector<Eigen::Vector3d> displacements;   ///< [node] u, m
  std::vector<Eigen::Vector3d> internalForces;  ///< [node] internal force, N: the reaction where held
  int freedoms = 0;                             ///< number of unknowns
  int iterations = 0;                           ///< of Newton, over all increments
  int negativePivots = 0;                       ///< of the last tangent: none where the equilibrium is stable
  double smallestJacobian = 1.0;                ///< of F at the end
};

/// Static equilibrium at the end of the last stage: Newton's method on the full tangent (for a follower pressure, its
/// symmetric part), increments halved where it fails. @errors throws std::runtime_error if an increment gets too small
Solution solve(const Model &model);

}  // namespace truth
