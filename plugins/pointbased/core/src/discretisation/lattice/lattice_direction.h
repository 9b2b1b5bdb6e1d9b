// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pointbased/body_shape.h"
#include "pointbased/region.h"

namespace pointbased::lattice {

/// Axes of the lattice in a body, columns, a rotation.
///
/// They follow the faces of a body that has faces. The misalignment is m(R) = 1 − Σ_t A_t Σ_a (n_t · r_a)⁴ / Σ A_t over
/// the triangles of the border: 0 if every face is along the lattice, 2/5 for a ball, and 2/3 at most. R is the minimum
/// of m if that is below 0.3. The axes of the world are kept if their m is at most 0.002 or a third of the minimum
/// larger. The minimum is found by rotations in the planes of two axes, each by its optimal angle (m is a cosine of
/// four times the angle), from several starts. A rotated surface gets the rotated axes, except for order and signs.
///
/// A body without such faces is aligned with the border of the first half-space that holds something, by the smallest
/// rotation from the axes of the world. Supports across cells scatter more than supports along them (see frameOver()).
/// Otherwise, and for bodies from voxels, the axes are those of the world.
/// @source  Comon, Independent component analysis, a new concept?, 1994: Jacobi sweeps over fourth moments
[[nodiscard]] Mat3 latticeDirection(const BodyShape &shape, std::span<const Region> held);

/// Misalignment m(R) of a surface, 0 … 2/3 (see latticeDirection()); 0 without triangles.
/// @param axes  columns, a rotation
[[nodiscard]] double misalignment(const Surface &surface, const Mat3 &axes);

}  // namespace pointbased::lattice
