// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/mask_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "c3de/core/text.h"
#include "c3de/imaging/masks.h"

namespace c3de::segmentation {
namespace {

using Index = std::array<std::size_t, 3>;

std::optional<Index> indexAt(const imaging::VolumeGeometry &grid, const Vec3 &world) {
  const Vec3 at = transformPoint(imaging::affineInverse(grid.indexToWorld), world);
  Index index{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double rounded = std::floor(at[a] + 0.5);
    if (!(rounded >= 0.0) || !(rounded < static_cast<double>(grid.size[a]))) return {};
    index[a] = static_cast<std::size_t>(rounded);
  }
  return index;
}

Expected<imaging::Mask> componentAt(const imaging::Mask &mask, const Vec3 &world, const ProgressFn &progress) {
  const auto index = indexAt(mask.geometry, world);
  const auto &n = mask.geometry.size;
  const bool isInside = index && mask.voxels[(*index)[0] + n[0] * ((*index)[1] + n[1] * (*index)[2])] != 0;
  if (!isInside)
    return fail(
        ErrorCode::usage,
        fmt::format("the click at LPS {:.1f}, {:.1f}, {:.1f} mm is outside of the mask; click on a coloured part",
                    world[0], world[1], world[2]));
  return imaging::connectedComponent(mask, *index, progress);
}

}  // namespace

std::string MaskStep::text() const {
  switch (kind) {
    case Kind::label: return "label " + std::to_string(label);
    case Kind::labels: return labels.empty() ? "nothing picked" : std::to_string(labels.size()) + " labels";
    case Kind::threshold: return "threshold " + formatNumber(low) + " … " + formatNumber(high);
    case Kind::component: return fmt::format("the part at {:.1f}, {:.1f}, {:.1f} mm", world[0], world[1], world[2]);
    case Kind::largest: return "the largest part";
    case Kind::fillHoles: return "holes filled";
    case Kind::close: return "closed by " + formatNumber(radius_mm) + " mm";
    case Kind::open: return "opened by " + formatNumber(radius_mm) + " mm";
  }
  return {};
}

Expected<imaging::Mask> carriedOut(const MaskStep &step, const MaskSources &sources, const imaging::Mask *before,
                                   const ProgressFn &progress) {
  using Kind = MaskStep::Kind;
  if (step.kind == Kind::threshold) {
    if (!sources.image) return fail(ErrorCode::usage, "a threshold needs an image, and none is open");
    return imaging::threshold(sources.image->volume, step.low, step.high, progress);
  }
  if (step.kind == Kind::label) {
    if (!sources.labels)
      return fail(ErrorCode::usage, "there is no label map to take label " + std::to_string(step.label) + " from");
    return imaging::maskOf(sources.labels->map, step.label);
  }
  if (!before || step.kind == Kind::labels)
    return fail(ErrorCode::usage, "nothing is picked yet; choose a label or a threshold first");
  switch (step.kind) {
    case Kind::component: return componentAt(*before, step.world, progress);
    case Kind::largest: return imaging::largestComponent(*before, progress);
    case Kind::fillHoles: return imaging::fillHoles(*before, progress);
    case Kind::close: return imaging::closed(*before, step.radius_mm, progress);
    default: return imaging::opened(*before, step.radius_mm, progress);
  }
}

MaskPreview previewOf(const imaging::Mask &mask, std::size_t mostVoxels) {
  const auto &n = mask.geometry.size;
  Index low = n, high{};
  const std::uint8_t *row = mask.voxels.data();
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j, row += n[0]) {
      const std::uint8_t *end = row + n[0], *first = std::find_if(row, end, [](std::uint8_t v) { return v != 0; });
      if (first == end) continue;
      const std::uint8_t *last = end - 1;
      while (*last == 0) --last;
      low = {std::min(low[0], static_cast<std::size_t>(first - row)), std::min(low[1], j), std::min(low[2], k)};
      high = {std::max(high[0], static_cast<std::size_t>(last - row)), std::max(high[1], j), std::max(high[2], k)};
    }
  MaskPreview preview;
  if (low[0] >= n[0]) return preview;
  const auto count = [&](std::size_t a) { return (high[a] - low[a]) / preview.stride + 1; };
  while (count(0) * count(1) * count(2) > std::max<std::size_t>(mostVoxels, 1)) ++preview.stride;
  imaging::VolumeGeometry &grid = preview.geometry;
  grid.size = {count(0), count(1), count(2)};
  // The first point of the preview coincides with a voxel; its steps are longer.
  const Vec3 origin =
      mask.geometry.worldAt({static_cast<double>(low[0]), static_cast<double>(low[1]), static_cast<double>(low[2])});
  for (std::size_t column = 0; column < 3; ++column)
    for (std::size_t r = 0; r < 3; ++r)
      grid.indexToWorld[4 * column + r] =
          static_cast<double>(preview.stride) * mask.geometry.indexToWorld[4 * column + r];
  for (std::size_t r = 0; r < 3; ++r) grid.indexToWorld[12 + r] = origin[r];
  preview.voxels.reserve(grid.voxelCount());
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j) {
      const std::size_t start = low[0] + n[0] * (low[1] + j * preview.stride + n[1] * (low[2] + k * preview.stride));
      for (std::size_t i = 0; i < grid.size[0]; ++i)
        preview.voxels.push_back(mask.voxels[start + i * preview.stride] != 0 ? 1 : 0);
    }
  return preview;
}

PackedMask::PackedMask(const imaging::Mask &mask) : geometry_(mask.geometry), bits_((mask.voxels.size() + 7) / 8) {
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v] != 0) bits_[v >> 3] = static_cast<std::uint8_t>(bits_[v >> 3] | 1u << (v & 7u));
}

imaging::Mask PackedMask::mask() const {
  imaging::Mask mask{geometry_, std::vector<std::uint8_t>(geometry_.voxelCount())};
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    mask.voxels[v] = static_cast<std::uint8_t>(bits_[v >> 3] >> (v & 7u) & 1u);
  return mask;
}

}  // namespace c3de::segmentation
