// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/volume.h"

/// What of a mask a body cannot stand for: too small, or outside of its skin. As in masks.h.
namespace c3de::imaging {

/// A mask without its specks: components of at most 64 voxels that have less than a thousandth of the largest one's.
struct Unspecked {
  Mask mask;
  std::size_t specks = 0, voxels = 0;  ///< components and voxels that were taken away
};
[[nodiscard]] Expected<Unspecked> withoutSpecks(const Mask &mask, const ProgressFn &progress = {});
/// What of a mask a closed surface leaves outside: voxels with neither their own centre nor that of a neighbour inside
/// of it. A surface that runs along the border of the mask, half a voxel off, leaves nothing.
[[nodiscard]] Mask notEnclosed(const Mask &mask, const geometry::TriangleMesh &surface);

}  // namespace c3de::imaging
