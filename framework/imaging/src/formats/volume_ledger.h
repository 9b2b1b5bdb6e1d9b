// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Volume is kept where it is lost: every vertex has an account of what the mesh encloses too little there
/// (EditMesh::owed). Whatever moves vertices books what that changed; settle() spreads the accounts over some
/// neighbours and moves each vertex along its normal by what is owed. So thin branches get back what smoothing took off
/// them, instead of having it paid to thick ones.

/// Books what moving the points from `before` to where they are has changed: per vertex, exact in the sum over each
/// part.
void bookMoves(EditMesh &mesh, std::span<const Vec3> before);

/// Spreads and pays.
/// @param edges  lengths by tag: no vertex goes farther than a quarter of one at a time
/// @param reach  how far accounts are spread, as many edges in the root mean square; what is lost and found again
///               within it (the steps of voxels) is not paid
/// @param times  payments, each of what the ones before left open
void settle(EditMesh &mesh, std::span<const double> edges, double reach, int times);

}  // namespace c3de::imaging
