// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/region_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/core/csv.h"
#include "c3de/core/text.h"
#include "masks/mask_tools.h"

namespace c3de::imaging {
namespace {

constexpr std::uint32_t kNoRegion = std::numeric_limits<std::uint32_t>::max();

/// Sums of one region.
struct Moments {
  RegionStatistics out;
  double squares = 0.0;  // of the differences from the mean

  void add(double value) {
    out.min = out.measured == 0 ? value : std::min(out.min, value);
    out.max = out.measured == 0 ? value : std::max(out.max, value);
    const double before = value - out.mean;
    out.mean += before / static_cast<double>(++out.measured);
    squares += before * (value - out.mean);
  }
  [[nodiscard]] RegionStatistics result() const {
    RegionStatistics done = out;
    if (out.measured > 1) done.sd = std::sqrt(squares / static_cast<double>(out.measured - 1));
    return done;
  }
};

/// @param regionOf  index of the region of a voxel's number; kNoRegion: none
template <class Voxel>
Expected<std::vector<RegionStatistics>> measure(const VolumeGeometry &grid, const std::vector<Voxel> &voxels,
                                                const std::vector<std::uint32_t> &regionOf, std::size_t regions,
                                                const Volume *image, const ProgressFn &progress) {
  std::vector<Moments> sums(regions);
  const bool isSame = image && sameGrid(grid, image->geometry);
  const Mat4 toImage = image ? multiply(affineInverse(image->geometry.indexToWorld), grid.indexToWorld) : Mat4{};
  const auto &n = grid.size;
  const auto pass = [&](const auto &valueOf) -> Expected<void> {
    std::size_t v = 0;
    for (std::size_t k = 0; k < n[2]; ++k) {
      for (std::size_t j = 0; j < n[1]; ++j)
        for (std::size_t i = 0; i < n[0]; ++i, ++v) {
          const std::uint32_t region = regionOf[voxels[v]];
          if (region == kNoRegion) continue;
          ++sums[region].out.voxels;
          valueOf(v, Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}, sums[region]);
        }
      if (!goesOn(progress, static_cast<double>(k + 1) / static_cast<double>(n[2]), "measuring regions"))
        return cancelled();
    }
    return {};
  };
  Expected<void> done;
  if (!image || !image->colours.empty()) {
    done = pass([](std::size_t, const Vec3 &, Moments &) {});
  } else {
    const auto &size = image->geometry.size;
    done = std::visit(
        [&](const auto &values) {
          return pass([&](std::size_t v, const Vec3 &index, Moments &sum) {
            std::size_t at = v;
            if (!isSame) {
              const auto voxel = voxelAt(image->geometry, transformPoint(toImage, index));
              if (!voxel) return;
              at = (*voxel)[0] + size[0] * ((*voxel)[1] + size[1] * (*voxel)[2]);
            }
            const double value = image->slope * static_cast<double>(values[at]) + image->intercept;
            if (std::isfinite(value)) sum.add(value);
          });
        },
        image->voxels);
  }
  if (!done) return tl::unexpected(done.error());
  std::vector<RegionStatistics> out;
  for (const Moments &sum : sums) out.push_back(sum.result());
  return out;
}

}  // namespace

Expected<std::vector<RegionStatistics>> statisticsOfLabels(const LabelMap &map, const Volume *image,
                                                           const ProgressFn &progress) {
  std::vector<std::uint32_t> regionOf(std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1, kNoRegion);
  for (std::size_t i = 0; i < map.labels.size(); ++i) regionOf[map.labels[i].value] = static_cast<std::uint32_t>(i);
  return measure(map.geometry, map.voxels, regionOf, map.labels.size(), image, progress);
}

Expected<RegionStatistics> statisticsOf(const Mask &mask, const Volume *image, const ProgressFn &progress) {
  std::vector<std::uint32_t> regionOf(std::size_t{std::numeric_limits<std::uint8_t>::max()} + 1, 0);
  regionOf[0] = kNoRegion;
  auto measured = measure(mask.geometry, mask.voxels, regionOf, 1, image, progress);
  if (!measured) return tl::unexpected(measured.error());
  return measured->front();
}

std::string statisticsCsv(const std::vector<NamedRegion> &regions, const std::string &unit) {
  std::string text = "label,name,voxels,volume_ml,measured,mean,sd,minimum,maximum,unit\n";
  for (const NamedRegion &one : regions) {
    const RegionStatistics &s = one.statistics;
    text += fmt::format("{},{},{},{},{},", one.label, csvCell(one.name), s.voxels,
                        formatNumber(static_cast<double>(s.voxels) * one.voxelVolume_mm3 / 1000.0), s.measured);
    text += s.measured > 0 ? fmt::format("{},{},{},{},{}\n", formatNumber(s.mean), formatNumber(s.sd),
                                         formatNumber(s.min), formatNumber(s.max), csvCell(unit))
                           : std::string(",,,,\n");
  }
  return text;
}

}  // namespace c3de::imaging
