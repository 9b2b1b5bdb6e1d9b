// SPDX-License-Identifier: Apache-2.0
// Images as bytes of a file: the input that writing.cpp passes to the writer of each format.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "formats/image_header.h"

namespace c3de::imaging {

struct ImageToWrite {
  VolumeGeometry geometry;
  Scalar scalar = Scalar::u8;
  std::size_t components = 1;           ///< values per voxel, interleaved
  std::string_view voxels;              ///< in native byte order, which is little-endian
  double slope = 1.0, intercept = 0.0;  ///< NIfTI only
  bool labels = false;
  std::vector<std::pair<std::string, std::string>> keys;  ///< NRRD only
};

[[nodiscard]] Expected<std::string> nrrdFile(const ImageToWrite &image);
[[nodiscard]] Expected<std::string> metaFile(const ImageToWrite &image);
/// Uncompressed. NIfTI-2 where an axis has more than 32767 voxels.
[[nodiscard]] Expected<std::string> niftiFile(const ImageToWrite &image);

}  // namespace c3de::imaging
