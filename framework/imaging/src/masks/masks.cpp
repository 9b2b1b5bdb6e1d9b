// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "masks/mask_tools.h"

namespace c3de::imaging {

Expected<Mask> threshold(const Volume &volume, double low, double high, const ProgressFn &progress) {
  if (std::isnan(low) || std::isnan(high) || low > high)
    return fail(
        ErrorCode::usage,
        fmt::format("threshold from {} to {}: two numbers are accepted, the first not above the second", low, high));
  const std::size_t count = volume.geometry.voxelCount();
  if (std::visit([](const auto &all) { return all.size(); }, volume.voxels) != count)
    return fail(ErrorCode::internal, "the voxels of the volume do not fit its geometry");
  Mask mask{volume.geometry, std::vector<std::uint8_t>(count)};
  constexpr std::size_t kChunk = std::size_t{1} << 22;
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    const std::size_t end = std::min(count, begin + kChunk);
    std::visit(
        [&](const auto &all) {
          const auto *voxels = all.data();
          std::uint8_t *out = mask.voxels.data();
          const double slope = volume.slope, intercept = volume.intercept;
          for (std::size_t v = begin; v < end; ++v) {
            const double value = slope * static_cast<double>(voxels[v]) + intercept;
            out[v] = static_cast<std::uint8_t>(static_cast<int>(value >= low) & static_cast<int>(value <= high));
          }
        },
        volume.voxels);
    if (!goesOn(progress, static_cast<double>(end) / static_cast<double>(count), "threshold")) return cancelled();
  }
  return mask;
}

Mask maskOf(const LabelMap &labels, std::uint16_t value) { return maskOf(labels, std::span(&value, 1)); }

Mask maskOf(const LabelMap &labels, std::span<const std::uint16_t> values) {
  std::vector<std::uint8_t> wanted(65536, 0);
  for (const std::uint16_t value : values) wanted[value] = 1;
  Mask mask{labels.geometry, std::vector<std::uint8_t>(labels.voxels.size())};
  std::transform(labels.voxels.begin(), labels.voxels.end(), mask.voxels.begin(),
                 [&](std::uint16_t label) { return wanted[label]; });
  return mask;
}

std::size_t voxelCount(const Mask &mask) {
  return static_cast<std::size_t>(
      std::count_if(mask.voxels.begin(), mask.voxels.end(), [](std::uint8_t v) { return v != 0; }));
}

double volumeOf(const Mask &mask) { return static_cast<double>(voxelCount(mask)) * mask.geometry.voxelVolume(); }

Expected<Mask> mended(Mask mask, const MaskCleanUp &how, const ProgressFn &progress) {
  Expected<Mask> out = std::move(mask);
  if (how.opening_mm > 0.0) out = opened(*out, how.opening_mm, progress);
  if (out && how.closing_mm > 0.0) out = closed(*out, how.closing_mm, progress);
  if (out && how.largest) out = largestComponent(*out, progress);
  if (out && how.fillHoles) out = fillHoles(*out, progress);
  return out;
}

Expected<LabelMap> resampled(const LabelMap &labels, const VolumeGeometry &grid, const ProgressFn &progress) {
  if (grid.voxelCount() == 0)
    return fail(ErrorCode::usage, fmt::format("a grid of {} x {} x {} voxels has none; each size has to be at least 1",
                                              grid.size[0], grid.size[1], grid.size[2]));
  LabelMap out{grid, std::vector<std::uint16_t>(grid.voxelCount(), 0), {}};
  const Mat4 toSource = multiply(affineInverse(labels.geometry.indexToWorld), grid.indexToWorld);
  const auto &n = labels.geometry.size;
  std::vector<std::uint8_t> occurs(65536, 0);
  std::uint16_t *voxel = out.voxels.data();
  for (std::size_t k = 0; k < grid.size[2]; ++k) {
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i, ++voxel) {
        const Vec3 at =
            transformPoint(toSource, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        std::array<std::size_t, 3> source{};
        bool within = true;
        for (std::size_t a = 0; a < 3; ++a) {
          const double nearest = std::floor(at[a] + 0.5);
          within = within && nearest >= 0.0 && nearest < static_cast<double>(n[a]);
          source[a] = within ? static_cast<std::size_t>(nearest) : 0;
        }
        if (!within) continue;
        *voxel = labels.voxels[source[0] + n[0] * (source[1] + n[1] * source[2])];
        occurs[*voxel] = 1;
      }
    if (!goesOn(progress, static_cast<double>(k + 1) / static_cast<double>(grid.size[2]), "resampling labels"))
      return cancelled();
  }
  for (const LabelMap::Label &label : labels.labels)
    if (occurs[label.value] != 0) out.labels.push_back(label);
  return out;
}

}  // namespace c3de::imaging
