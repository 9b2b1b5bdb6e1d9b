// SPDX-License-Identifier: Apache-2.0
// Forces on a body that its fine reference does not compute itself, and their transfer to the fine reference. Private
// to the core.
#pragma once

#include "pointbased/integrators.h"

namespace pointbased::detail {

/// Forces that the fine reference of a body computes itself, on the phyxels at their current displacements, N: elastic
/// forces, loads, gravity, foundation, patch springs. Leaves body.forces() and the patch forces such that reactions()
/// are the static ones.
/// @param clock  s, or load factor
[[nodiscard]] std::vector<Vec3> knownForces(Body &body, const Vec3 &gravity, double clock,
                                            const ParallelFor &parallelFor);

/// Transfers forces on the phyxels of a body to those of its fine reference. Forces on phyxels under contact points are
/// transferred as a density per area of the skin, all others as a density per mass.
/// @param forces  [phyxels of the body] N
/// @param withContact  false: omits forces on phyxels in contact
[[nodiscard]] std::vector<Vec3> carriedOver(const Body &body, std::span<const Vec3> forces, bool withContact,
                                            const Body &fineReference, const ParallelFor &parallelFor);

/// Contact points of the fine reference where the body presses against something, in the frame of the fine reference,
/// m.
[[nodiscard]] SurfacePoints touchingPoints(const Body &body, const RestState &fineReference);

/// Removes from `forces` the part that accelerates the fine reference as a whole, so that the sum with `others` is in
/// balance.
void balance(const Body &fineReference, std::span<const Vec3> others, std::span<Vec3> forces);

/// Inertia, 1/s², against which dead forces on a free body cannot turn it over. A body that is pushed rather than
/// pulled is in an unstable balance.
[[nodiscard]] double holdingAgainstTurns(const Body &fineReference, std::span<const Vec3> forces);

}  // namespace pointbased::detail
