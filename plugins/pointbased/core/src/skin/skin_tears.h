// SPDX-License-Identifier: Apache-2.0
// Where the lattice lets go of a skin that goes on. Private to the core.
#pragma once

#include "pointbased/interpolation.h"
#include "pointbased/surface.h"

namespace pointbased::detail {

/// Where a bridge of the body is thinner than the lattice can see, its cells come apart and so would neighbouring
/// points of the skin, by any distance. Around such edges the rows of the points become means of the rows of those
/// around them on the skin, over half a spacing on either side, so that the skin spans the gap as a band of that width.
/// Affine motions are followed exactly as before; points that are farther from every torn edge keep their rows, bit for
/// bit.
/// @param surface  as `binding` binds its vertices
/// @param spacing  of the phyxels, m
/// @return torn edges
std::size_t closeTears(const Surface &surface, double spacing, Interpolation &binding);

}  // namespace pointbased::detail
