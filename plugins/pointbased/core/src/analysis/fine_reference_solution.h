// SPDX-License-Identifier: Apache-2.0
// Equilibrium of the fine reference of a body. Private to the core.
#pragma once

#include "pointbased/verification.h"

namespace pointbased::detail {

/// Input of a solution, and its progress callback.
struct FineReferenceProblem {
  const VerificationTarget &target;
  Body &body;  ///< in its current state; its forces are those of knownForces()
  const ParallelFor &parallelFor;
  const StopRequest *stop = nullptr;
  bool isLast = true;  ///< false: if this one has no direct solution, another fine reference is tried
  std::function<bool(double fraction)> goesOn;  ///< returns false: cancelled
};

struct FineReferenceState {
  std::vector<Vec3> displacements;  ///< [phyxels of the fine reference] m
  std::vector<Reaction> reactions;  ///< by fix
  double elasticEnergy = 0.0;       ///< J
  bool isHeldByContact = false;     ///< nothing else supports the body: it is held where it is in contact
};

/// Solves from the current displacements of the body; the remaining forces of the body are prescribed.
/// @param leftOver  [phyxels of the body] N
[[nodiscard]] Result<FineReferenceState> solveDirectly(const FineReferenceProblem &problem,
                                                       std::span<const Vec3> leftOver,
                                                       std::unique_ptr<Body> fineReference);
/// Solves along the loading path of a quasi-static solution from its beginning.
[[nodiscard]] Result<FineReferenceState> solveAlongLoadPath(const FineReferenceProblem &problem,
                                                            std::unique_ptr<Body> fineReference);

}  // namespace pointbased::detail
