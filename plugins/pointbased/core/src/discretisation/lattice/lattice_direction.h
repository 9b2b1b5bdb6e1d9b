// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body_shape.h"

namespace pointbased::lattice {

/// Along which axes to lay the lattice into a body, columns, a rotation: those that its faces are along, as far as it
/// has faces.
///
/// With the misalignment m(R) = 1 − Σ_t A_t Σ_a (n_t · r_a)⁴ / Σ A_t over the triangles of the border, 0 where every
/// face is along the lattice, 2/5 for a ball and 2/3 at most: the R of the least m, where it is at least a quarter
/// below that of the world's axes; else, and for bodies from voxels, the world's axes. The maximum is found by turns in
/// the planes of two axes, each to its own best angle (m is a cosine of four times the angle), from several starts.
/// The same for the same surface; a turned surface gets the turned axes, but for their names and signs.
/// @source  Comon, Independent component analysis, a new concept?, 1994: Jacobi sweeps over fourth moments
[[nodiscard]] Mat3 latticeDirection(const BodyShape &shape);

}  // namespace pointbased::lattice
