// SPDX-License-Identifier: Apache-2.0
// What acts on a body beside what its shadow knows itself, and how it comes to the shadow. Private to the core.
#pragma once

#include "pointbased/integrators.h"

namespace pointbased::detail {

/// What the shadow of a body computes itself, on the phyxels at their present displacements, N: elastic forces, loads,
/// gravity, surroundings, springs of patches. Leaves body.forces() and those of the patches so that reactions() are the
/// static ones.
/// @param clock  s, or load factor
[[nodiscard]] std::vector<Vec3> knownForces(Body &body, const Vec3 &gravity, double clock,
                                            const ParallelFor &parallelFor);

/// Forces on the phyxels of a body as forces on those of its shadow: of phyxels under points that touch something as a
/// density of the skin, of others as one of the mass.
/// @param forces       [phyxels of the body] N
/// @param withContact  false: without those of phyxels that touch
[[nodiscard]] std::vector<Vec3> carriedOver(const Body &body, std::span<const Vec3> forces, bool withContact,
                                            const Body &shadow, const ParallelFor &parallelFor);

/// The points of contact of the shadow where the body presses against something; in the frame of the shadow, m.
[[nodiscard]] SurfacePoints touchingPoints(const Body &body, const RestState &shadow);

/// Takes from `forces` what accelerates the shadow as a whole, so that the sum with `others` is in balance.
void balance(const Body &shadow, std::span<const Vec3> others, std::span<Vec3> forces);

/// Inertia, 1/s², beside which dead forces on a free body cannot turn it over: what is pushed rather than pulled is
/// in a balance that is not stable.
[[nodiscard]] double holdingAgainstTurns(const Body &shadow, std::span<const Vec3> forces);

}  // namespace pointbased::detail
