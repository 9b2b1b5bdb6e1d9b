// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pointbased/body_shape.h"
#include "pointbased/region.h"

namespace pointbased::lattice {

/// Along which axes to lay the lattice into a body, columns, a rotation.
///
/// Those that its faces are along, where it has faces. With the misalignment m(R) = 1 − Σ_t A_t Σ_a (n_t · r_a)⁴ / Σ A_t
/// over the triangles of the border, 0 where every face is along the lattice, 2/5 for a ball and 2/3 at most: the R of
/// the least m, where that is below 0.3; the world's axes where these have no more than 0.002 or a third of it more. The
/// least is found by turns in the planes of two axes, each to its own best angle (m is a cosine of four times the
/// angle), from several starts. A turned surface gets the turned axes, but for their names and signs.
///
/// Of a body without such faces along the border of the first half-space that holds something, by the smallest turn from
/// the world's axes: what is held across its cells scatters more than what is held along them (see frameOver()). Else,
/// and for bodies from voxels, the world's axes.
/// @source  Comon, Independent component analysis, a new concept?, 1994: Jacobi sweeps over fourth moments
[[nodiscard]] Mat3 latticeDirection(const BodyShape &shape, std::span<const Region> held);

}  // namespace pointbased::lattice
