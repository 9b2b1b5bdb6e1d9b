// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"

namespace pointbased {

/// Norm of the plastic Hencky strain since the reference was made from which on it is worn: a stretch of 1.5 in
/// tension. The reference is renewed when this part of the volume is worn, or one point twice as much.
inline constexpr double kWornStrain = 0.5;
inline constexpr double kWornShare = 0.05;

/// Whether flow has gone so far that the reference should be renewed. False for the linear law, which does not flow,
/// and for bodies without plasticity. Costs eigenvalues only where much has flowed.
[[nodiscard]] bool needsRereferencing(const Body &body);

/// A body in its present shape, seen from there.
struct Rereferencing {
  std::shared_ptr<const RestState> rest;
  State state;
  std::size_t relieved = 0;  ///< points that were flat or inverted and have lost their elastic strain
};

/// Makes the present shape the reference. F = Fe Fp of every point becomes F' = V, Fp' = I, where Fe = V R: the stress,
/// and what it stores, stay; flow goes on from there; the total flow stays known for Plasticity::max.
///
/// Phyxels, masses, volumes and velocities of a cloud stay what they are, so both momenta are the same to the last bit.
/// Neighbours, moments, skin and contact points are those of the present positions. A pair may become neighbours if no
/// more than three steps between neighbours have led from one to the other: parts that touch do not grow together.
/// Supports hold what they held and go on with its motion; a follower load goes on with the surface it has now.
///
/// A lattice is filled anew inside its present skin, with cells of the same size. Elastic strain (its logarithm in
/// space) and velocities are fitted linearly to the nearest old points and phyxels; then a rigid motion is added that
/// makes both momenta what they were. The mass stays; volumes are scaled by what rounding and the facets of the skin
/// leave. Strain energy moves by what the fit smooths, the centre of mass by what the cut cells do: see the theory page
/// for figures.
///
/// @param body  one whose gradients are those of its present displacements
/// Errors: a body that its surroundings hold (ElasticFoundation); a phyxel whose neighbours no longer span space; a
/// state that is not finite; for lattices: no RestState::reshape, supports, loads, refinements or several materials,
/// which are given in the first shape; a skin that holds another volume than the points do, by more than kSkinMismatch.
inline constexpr double kSkinMismatch = 0.1;
[[nodiscard]] Result<Rereferencing> rereferenced(const Body &body, const ParallelFor &parallelFor);

}  // namespace pointbased
