// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

/// Image values in regions.
namespace c3de::imaging {

struct RegionStatistics {
  std::size_t voxels = 0;    ///< of the region
  std::size_t measured = 0;  ///< of them with their centre in the image, and a finite value there
  double mean = 0.0, sd = 0.0, min = 0.0, max = 0.0;  ///< image values; 0 if none was measured
};

/// Values at the centres of the voxels of each label, in the order of the map's labels: those of the nearest voxels of
/// the image, whose grid may differ. The standard deviation is that of a sample (n - 1). Any thread.
/// @param image  null, or with colours: only voxels are counted
/// Errors: cancelled.
/// @source mean and variance in one pass: Welford, Technometrics 4 (1962) 419
[[nodiscard]] Expected<std::vector<RegionStatistics>> statisticsOfLabels(const LabelMap &map, const Volume *image,
                                                                         const ProgressFn &progress = {});
/// The same for the inside of a mask.
[[nodiscard]] Expected<RegionStatistics> statisticsOf(const Mask &mask, const Volume *image,
                                                      const ProgressFn &progress = {});

struct NamedRegion {
  std::string label;  ///< its value; empty: a mask
  std::string name;
  RegionStatistics statistics;
  double voxelVolume_mm3 = 0.0;
};
/// CSV, a line for each region: label, name, voxels, volume_ml, measured, mean, sd, minimum, maximum, unit. The last
/// five are empty where nothing was measured.
/// @param unit  of the image values; may be empty
[[nodiscard]] std::string statisticsCsv(const std::vector<NamedRegion> &regions, const std::string &unit);

}  // namespace c3de::imaging
