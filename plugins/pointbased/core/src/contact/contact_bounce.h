// SPDX-License-Identifier: Apache-2.0
// Points that bounce off what they hit, in explicit steps. Private to the core.
#pragma once

#include "pointbased/contact.h"

namespace pointbased {

/// Whether points arrive within dt at surfaces with restitution, faster than quietSpeed; they did not press before.
/// They are remembered for bounceArrivals().
/// @param velocities  [phyxels] m/s, with which the step would go on
[[nodiscard]] bool findArrivals(const Interpolation &binding, std::span<const Vec3> velocities, double dt,
                                double quietSpeed, ContactState &memory);

/// Lets them bounce: 1 + e times the impulses that stop them all, so that each leaves with e times its speed where
/// nothing else pushes. Of the kinetic energy that the impulses take at e = 0 they take 1 - e², nothing at e = 1, and
/// never add any, however many points arrive at once and whatever restitution each has (seen from the obstacles; one
/// that moves may).
///
/// @param velocities  [phyxels] m/s, at the same time as the positions: the energy of velocity Verlet counts with
///                    these; half a kick later, they hold what a compressed body pushes against the surface, and
///                    bouncing with it would be energy from nothing
/// @return total impulse on the body, N s
/// @source  Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988 (restitution at several
/// contacts)
Vec3 bounceArrivals(const Interpolation &binding, std::span<const double> inverseMasses, double quietSpeed,
                    ContactState &memory, std::span<Vec3> velocities);

}  // namespace pointbased
