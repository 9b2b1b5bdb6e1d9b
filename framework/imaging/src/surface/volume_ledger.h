// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Restores volume close to where it is lost. Every vertex has an account of the volume that the mesh is missing there
/// (EditMesh::owed). Functions that move vertices record the change; compensateVolume() spreads the accounts over some
/// neighbours and moves each vertex along its normal to compensate. Thin branches thus regain the volume lost by
/// smoothing, instead of thick ones gaining it.

/// Records the volume change due to moving the points from `before` to their present positions: per vertex, exact in
/// the sum over each part.
void recordMoves(EditMesh &mesh, std::span<const Vec3> before);

/// Spreads the accounts and compensates them.
/// @param edges  lengths by tag: a vertex moves at most a quarter of one at a time
/// @param reach  distance over which accounts are spread, in edges (root mean square); volume lost and regained within
///               it (the steps of voxels) needs no compensation
/// @param times  compensation steps, each for the remainder of the previous ones
void compensateVolume(EditMesh &mesh, std::span<const double> edges, double reach, int times);

}  // namespace c3de::imaging
