// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

/// Files as ITK reads them; no ITK types in the interface.
namespace itk_truth {

struct Image {
  c3de::imaging::VolumeGeometry geometry;
  std::vector<double> values;  ///< rescaled, i fastest
};

/// NIfTI, NRRD or MetaImage by the name. Errors: ITK's message.
/// @param time  of several volumes. Colours become their luminance.
[[nodiscard]] c3de::Expected<Image> read(const std::filesystem::path &file, std::size_t time = 0);
/// Files of a DICOM series in the order of their positions, as ITK finds them in a folder with one series.
[[nodiscard]] c3de::Expected<Image> readSeries(const std::filesystem::path &folder);

}  // namespace itk_truth
