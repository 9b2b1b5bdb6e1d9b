// SPDX-License-Identifier: Apache-2.0
// Closes tears of a continuous skin where the cells of the lattice separate. Private to the core.
#pragma once

#include "pointbased/interpolation.h"
#include "pointbased/surface.h"

namespace pointbased::detail {

/// Where a bridge of the body is thinner than the lattice can resolve, its cells separate, and neighbouring points of
/// the skin would move apart without limit. Around such torn edges the row of a point becomes the mean of the rows
/// around it on the skin, over half a spacing on either side. The skin then spans the gap as a band of that width.
/// Affine motions are followed exactly as before. Points farther from all torn edges keep their rows bit for bit.
/// @param surface  its vertices are bound by `binding`
/// @param spacing  of the phyxels, m
/// @return number of torn edges
std::size_t closeTears(const Surface &surface, double spacing, Interpolation &binding);

}  // namespace pointbased::detail
