// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"

namespace pointbased {

/// Norm of the plastic Hencky strain since the last reference at which a point is worn: a stretch of 1.5 in tension.
/// The reference is renewed if this part of the volume is worn, or if one point has twice that strain.
inline constexpr double kWornStrain = 0.5;
inline constexpr double kWornShare = 0.05;

/// Whether plastic flow requires a new reference. False for the linear law, which does not flow, and for bodies without
/// plasticity. Eigenvalues are computed only where flow is large.
[[nodiscard]] bool needsRereferencing(const Body &body);

/// A body with its current shape as reference.
struct Rereferencing {
  std::shared_ptr<const RestState> rest;
  State state;
  std::size_t relieved = 0;  ///< points that were flat or inverted and lost their elastic strain
};

/// Makes the current shape the reference. F = Fe Fp of every point becomes F' = V, Fp' = I, where Fe = V R. Stress and
/// stored energy are preserved, flow continues, and the total flow remains available to Plasticity::max.
///
/// Phyxels, masses, volumes and velocities of a cloud are unchanged, so both momenta are the same to the last bit.
/// Neighbours, moments, skin and contact points are computed from the current positions. A pair can become neighbours
/// only if at most three steps between neighbours connected the two: parts that touch do not grow together. Supports
/// hold the same material and continue its motion; a follower load continues on the current surface.
///
/// A lattice is filled again inside its current skin, with cells of the same size. Elastic strain (its logarithm in
/// space) and velocities are fitted linearly to the nearest old points and phyxels. A rigid motion is then added that
/// restores both momenta. The mass is preserved; volumes are scaled by the residual of rounding and of the facets of
/// the skin. Strain energy changes by the smoothing of the fit, the centre of mass by the cut cells; the theory page
/// has figures.
///
/// @param body  its gradients must be those of its current displacements
/// Errors: a body held by a foundation (ElasticFoundation); a phyxel whose neighbours no longer span space; a state
/// that is not finite. For lattices also: no RestState::reshape; supports, loads, refinements or several materials,
/// which are specified in the first shape; a skin whose volume differs from that of the points by more than
/// kSkinMismatch.
inline constexpr double kSkinMismatch = 0.1;
[[nodiscard]] Result<Rereferencing> rereferenced(const Body &body, const ParallelFor &parallelFor);

}  // namespace pointbased
