// SPDX-License-Identifier: Apache-2.0
// The equilibrium of a body's shadow. Private to the core.
#pragma once

#include "pointbased/verification.h"

namespace pointbased::detail {

/// x = R (X - centre) + centre + shift: the rigid motion nearest to one of points, by weight.
struct RigidFit {
  Mat3 rotation = Mat3::Identity();
  Vec3 centre = Vec3::Zero(), shift = Vec3::Zero();  ///< m
  [[nodiscard]] Vec3 operator()(const Vec3 &X) const { return rotation * (X - centre) + centre + shift; }
};
/// @source  Kabsch, A solution for the best rotation to relate two sets of vectors, Acta Cryst. A32, 1976
[[nodiscard]] RigidFit rigidFit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights);

/// What the solution is about, and how to tell how far it has come.
struct ShadowProblem {
  const StandingBody &standing;
  Body &body;  ///< as it stands, its forces those of knownForces()
  const ParallelFor &parallelFor;
  const StopRequest *stop = nullptr;
  bool isLast = true;  ///< false: another shadow is tried where this one has no solution at once
  std::function<bool(double fraction)> goesOn;  ///< false: cancelled
};

struct ShadowState {
  std::vector<Vec3> displacements;  ///< [phyxels of the shadow] m
  std::vector<Reaction> reactions;  ///< by fix
  double elasticEnergy = 0.0;       ///< J
  bool leansOnContact = false;      ///< nothing else holds the body: it stays where it touches something
};

/// From the present displacements of the body, with what is left over of its forces as given.
/// @param leftOver  [phyxels of the body] N
[[nodiscard]] Result<ShadowState> solveFromHere(const ShadowProblem &problem, std::span<const Vec3> leftOver,
                                                std::unique_ptr<Body> shadow);
/// Along the way of a quasi-static solution from its beginning.
[[nodiscard]] Result<ShadowState> solveAlongTheWay(const ShadowProblem &problem, std::unique_ptr<Body> shadow);

}  // namespace pointbased::detail
