// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/body.h"

namespace reference {

/// u_s = sum_i w_i (u_i + (grad u_i)^T (X_s - X_i)) / sum_i w_i,  w_i = exp(-|X_s - X_i|²/h²), over the nearest
/// phyxels; h is the distance of the farthest of them.
///
/// @param point  X_s, m
/// @param count  nearest phyxels, 1 … all of them
/// @pre     J of the body belongs to its displacements (computeForces)
/// @source  thesis, (6.11); Müller et al. 2004, surface animation
[[nodiscard]] Vec3 surfelDisplacement(const Body &body, const Vec3 &point, std::size_t count = 16);

}  // namespace reference
