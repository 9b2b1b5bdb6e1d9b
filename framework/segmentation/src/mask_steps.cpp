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

Expected<imaging::Mask> componentAt(const imaging::Mask &mask, const Vec3 &world, const ProgressFn &progress) {
  const auto index =
      imaging::voxelAt(mask.geometry, transformPoint(imaging::affineInverse(mask.geometry.indexToWorld), world));
  const auto &n = mask.geometry.size;
  const bool isInside = index && mask.voxels[(*index)[0] + n[0] * ((*index)[1] + n[1] * (*index)[2])] != 0;
  if (!isInside)
    return fail(
        ErrorCode::usage,
        fmt::format("the click at LPS {:.1f}, {:.1f}, {:.1f} mm is outside of the mask; click on a coloured part",
                    world[0], world[1], world[2]));
  return imaging::connectedComponent(mask, *index, progress);
}

/// The mask before, or an empty one: on the grid of the label map, so that it can become a label of it, otherwise on
/// that of the image.
Expected<imaging::Mask> startOf(const imaging::Mask *before, const MaskSources &sources) {
  if (before) return *before;
  if (!sources.image && !sources.labels) return fail(ErrorCode::usage, "painting needs an image, and none is open");
  const imaging::VolumeGeometry &grid = sources.labels ? sources.labels->map.geometry : sources.image->volume.geometry;
  return imaging::Mask{grid, std::vector<std::uint8_t>(grid.voxelCount())};
}

Expected<imaging::Mask> painted(const MaskStep &step, const MaskSources &sources, const imaging::Mask *before) {
  if (!before && step.stroke.isErasing) return fail(ErrorCode::usage, "nothing is picked yet that could be erased");
  auto mask = startOf(before, sources);
  if (!mask) return mask;
  const auto done = imaging::paint(*mask, step.stroke, sources.image ? &sources.image->volume : nullptr);
  if (!done) return tl::unexpected(done.error());
  return mask;
}

/// Along the painted direction if there is an empty slice along it, otherwise along the axis with the most of them.
Expected<imaging::Mask> filledBetween(const MaskStep &step, const imaging::Mask &before, const ProgressFn &progress) {
  const std::array<std::size_t, 3> empty = imaging::emptySlicesBetween(before);
  auto axis = static_cast<std::size_t>(std::max_element(empty.begin(), empty.end()) - empty.begin());
  if (step.stroke.normal)
    if (const std::size_t painted = imaging::axisAlong(before.geometry, *step.stroke.normal); empty[painted] > 0)
      axis = painted;
  return imaging::filledBetweenSlices(before, axis, progress);
}

Expected<imaging::Mask> grownAt(const MaskStep &step, const MaskSources &sources, const imaging::Mask *before,
                                const ProgressFn &progress) {
  if (!sources.image) return fail(ErrorCode::usage, "growing a region needs an image, and none is open");
  auto mask = startOf(before, sources);
  if (!mask) return mask;
  const auto region =
      imaging::regionAround(sources.image->volume, step.world, step.tolerance, step.radius_mm, progress);
  if (!region) return region;
  const imaging::Mask added = imaging::onGrid(*region, mask->geometry);
  for (std::size_t v = 0; v < added.voxels.size(); ++v)
    if (added.voxels[v] != 0) mask->voxels[v] = 1;
  return mask;
}

}  // namespace

std::string MaskStep::text() const {
  switch (kind) {
    case Kind::label: return "label " + std::to_string(label);
    case Kind::labels: return labels.empty() ? "nothing picked" : std::to_string(labels.size()) + " labels";
    case Kind::restored: return "taken from a session or a body";
    case Kind::threshold: return "threshold " + formatNumber(low) + " … " + formatNumber(high);
    case Kind::component: return fmt::format("the part at {:.1f}, {:.1f}, {:.1f} mm", world[0], world[1], world[2]);
    case Kind::largest: return "the largest part";
    case Kind::fillHoles: return "holes filled";
    case Kind::close: return "closed by " + formatNumber(radius_mm) + " mm";
    case Kind::open: return "opened by " + formatNumber(radius_mm) + " mm";
    case Kind::paint: return stroke.isErasing ? "erased" : "painted";
    case Kind::grow: return fmt::format("grown at {:.1f}, {:.1f}, {:.1f} mm", world[0], world[1], world[2]);
    case Kind::fillBetween: return "slices filled between";
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
  if (step.kind == Kind::paint) return painted(step, sources, before);
  if (step.kind == Kind::grow) return grownAt(step, sources, before, progress);
  if (!before || step.ignoresPreviousMask())
    return fail(ErrorCode::usage, "nothing is picked yet; choose a label or a threshold, or paint first");
  switch (step.kind) {
    case Kind::component: return componentAt(*before, step.world, progress);
    case Kind::largest: return imaging::largestComponent(*before, progress);
    case Kind::fillHoles: return imaging::fillHoles(*before, progress);
    case Kind::close: return imaging::closed(*before, step.radius_mm, progress);
    case Kind::fillBetween: return filledBetween(step, *before, progress);
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

PackedMask::PackedMask(const imaging::Mask &mask) : geometry_(mask.geometry) {
  const std::size_t count = mask.voxels.size(), bitBytes = (count + 7) / 8;
  std::uint32_t length = 0;
  bool isInside = false;
  for (std::size_t v = 0; v < count && 4 * runs_.size() < bitBytes; ++v) {
    const bool isThis = mask.voxels[v] != 0;
    if (isThis != isInside || length == std::numeric_limits<std::uint32_t>::max()) {
      runs_.push_back(length);
      // A run that is too long continues after an empty one.
      if (isThis == isInside) runs_.push_back(0);
      isInside = isThis;
      length = 0;
    }
    ++length;
  }
  runs_.push_back(length);
  if (4 * runs_.size() < bitBytes) {
    runs_.shrink_to_fit();
    return;
  }
  runs_ = std::vector<std::uint32_t>();
  bits_.resize(bitBytes);
  for (std::size_t v = 0; v < count; ++v)
    if (mask.voxels[v] != 0) bits_[v >> 3] = static_cast<std::uint8_t>(bits_[v >> 3] | 1u << (v & 7u));
}

imaging::Mask PackedMask::mask() const {
  imaging::Mask mask{geometry_, std::vector<std::uint8_t>(geometry_.voxelCount())};
  if (!runs_.empty()) {
    auto at = mask.voxels.begin();
    for (std::size_t run = 0; run < runs_.size(); at += runs_[run++])
      if (run % 2 == 1) std::fill_n(at, runs_[run], std::uint8_t{1});
    return mask;
  }
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    mask.voxels[v] = static_cast<std::uint8_t>(bits_[v >> 3] >> (v & 7u) & 1u);
  return mask;
}

}  // namespace c3de::segmentation
