// SPDX-License-Identifier: Apache-2.0
// Masks as the inside fraction of every voxel, or block of voxels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "masks/mask_tools.h"

namespace c3de::imaging {

std::array<std::size_t, 3> blocksUpTo(const VolumeGeometry &geometry, double edge_mm) {
  const Vec3 spacing = geometry.spacing();
  std::array<std::size_t, 3> block{};
  for (std::size_t a = 0; a < 3; ++a)
    block[a] = static_cast<std::size_t>(
        std::clamp(edge_mm * (1.0 + 1e-9) / spacing[a], 1.0, static_cast<double>(geometry.size[a])));
  return block;
}

Fill fillInBlocks(const Mask &mask, const VoxelBox &box, const std::array<std::size_t, 3> &block) {
  Fill out{mask.geometry, {}};
  auto &size = out.geometry.size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = (box.edge(a) + block[a] - 1) / block[a] + 2;
  out.values.assign(size[0] * size[1] * size[2], 0.0f);
  const auto &n = mask.geometry.size;
  std::vector<std::size_t> column(box.edge(0));
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = 1 + i / block[0];
  for (std::size_t k = box.min[2]; k < box.max[2]; ++k)
    for (std::size_t j = box.min[1]; j < box.max[1]; ++j) {
      const std::uint8_t *row = mask.voxels.data() + box.min[0] + n[0] * (j + n[1] * k);
      const std::size_t y = 1 + (j - box.min[1]) / block[1], z = 1 + (k - box.min[2]) / block[2];
      float *line = out.values.data() + size[0] * (y + size[1] * z);
      for (std::size_t i = 0; i < column.size(); ++i)
        if (row[i] != 0) line[column[i]] += 1.0f;
    }
  // Integer counts first, so that a full block is exactly 1.
  const auto whole = static_cast<float>(block[0] * block[1] * block[2]);
  for (float &value : out.values) value /= whole;
  Vec3 first{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto b = static_cast<double>(block[a]);
    first[a] = static_cast<double>(box.min[a]) + 0.5 * (b - 1.0) - b;
    for (std::size_t c = 0; c < 3; ++c) out.geometry.indexToWorld[4 * a + c] *= b;
  }
  const Vec3 origin = mask.geometry.worldAt(first);
  for (std::size_t c = 0; c < 3; ++c) out.geometry.indexToWorld[12 + c] = origin[c];
  return out;
}

Expected<Fill> fillOf(const Mask &mask, double coarsest_mm) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  if (!(coarsest_mm >= 0.0) || !std::isfinite(coarsest_mm))
    return fail(ErrorCode::usage, fmt::format("blocks of {} mm are not accepted: finite and >= 0", coarsest_mm));
  const VoxelBox box = boxAround(mask);
  if (box.empty()) return fail(ErrorCode::usage, "the mask is empty: nothing is filled");
  return fillInBlocks(mask, box, blocksUpTo(mask.geometry, coarsest_mm));
}

}  // namespace c3de::imaging
