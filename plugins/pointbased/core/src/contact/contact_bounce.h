// SPDX-License-Identifier: Apache-2.0
// Restitution of contact points in explicit steps. Private to the core.
#pragma once

#include "pointbased/contact.h"

namespace pointbased {

/// Whether points without a contact force reach surfaces with restitution within dt, faster than restitutionThreshold.
/// These points are stored for applyRestitution().
/// @param velocities  [phyxels] velocities of the step without restitution, m/s
[[nodiscard]] bool findImpacts(const Interpolation &binding, std::span<const Vec3> velocities, double dt,
                               double restitutionThreshold, ContactState &memory);

/// Applies restitution to the stored points: 1 + e times the impulses that stop all of them. Each leaves with e times
/// its speed of arrival where nothing else pushes it. The impulses remove 1 - e² of the kinetic energy that they remove
/// at e = 0, none at e = 1. They never add energy relative to the obstacles, for any number of simultaneous contacts
/// and any combination of coefficients; a moving obstacle may add some.
///
/// @param velocities  [phyxels] m/s, at the same time as the positions, because the energy of velocity Verlet uses
///                    these. Half a kick later they include the push of a compressed body against the surface;
///                    restitution of that would create energy.
/// @return total impulse on the body, N s
/// @source  Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988 (restitution at several
/// contacts)
Vec3 applyRestitution(const Interpolation &binding, std::span<const double> inverseMasses, double restitutionThreshold,
                      ContactState &memory, std::span<Vec3> velocities);

}  // namespace pointbased
