// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/volume.h"

/// The parts of a mask that a body cannot represent: too small, or outside its skin. Conventions as in masks.h.
namespace c3de::imaging {

/// A mask without its specks: components of at most 64 voxels that have less than a thousandth of the largest one's.
struct WithoutSpecks {
  Mask mask;
  std::size_t specks = 0, voxels = 0;  ///< removed components and voxels
};
[[nodiscard]] Expected<WithoutSpecks> removeSpecks(const Mask &mask, const ProgressFn &progress = {});
/// The part of a mask outside a closed surface: voxels with neither their own centre nor that of a neighbour inside it.
/// Empty for a surface along the border of the mask, half a voxel away.
[[nodiscard]] Mask notEnclosed(const Mask &mask, const geometry::TriangleMesh &surface);

}  // namespace c3de::imaging
