// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/masks.h"

namespace c3de::imaging {

[[nodiscard]] inline bool goesOn(const ProgressFn &progress, double fraction, const char *what) {
  return !progress || progress(fraction, what);
}
[[nodiscard]] inline tl::unexpected<Error> cancelled() { return fail(ErrorCode::cancelled, "cancelled"); }

/// Progress of a stage between two fractions of the whole.
[[nodiscard]] inline ProgressFn stage(const ProgressFn &progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double f, const std::string &what) { return progress(from + (to - from) * f, what); };
}

[[nodiscard]] inline Expected<void> checkMask(const Mask &mask) {
  if (mask.voxels.size() == mask.geometry.voxelCount() && !mask.voxels.empty()) return {};
  return fail(ErrorCode::internal, "the voxels of the mask do not fit its geometry");
}

/// A box of voxels, [min, max).
struct VoxelBox {
  std::array<std::size_t, 3> min{}, max{};
  [[nodiscard]] bool empty() const { return max[0] <= min[0]; }
  [[nodiscard]] std::size_t edge(std::size_t axis) const { return max[axis] - min[axis]; }
};
/// Bounding box of all inside voxels; empty if there are none.
[[nodiscard]] VoxelBox boxAround(const Mask &mask);

/// Voxels per block along each axis, so that the block's edges do not exceed the given length; at least one.
[[nodiscard]] std::array<std::size_t, 3> blocksUpTo(const VolumeGeometry &geometry, double edge_mm);
/// The mask within a box in blocks of voxels, with an empty layer around it.
[[nodiscard]] Fill fillInBlocks(const Mask &mask, const VoxelBox &box, const std::array<std::size_t, 3> &block);

}  // namespace c3de::imaging
