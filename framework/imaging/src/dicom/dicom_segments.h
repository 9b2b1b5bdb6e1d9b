// SPDX-License-Identifier: Apache-2.0
// DICOM segmentations, PS3.3 A.51 and C.8.20: attributes of their headers, and their frames as label maps.
#pragma once

#include "dicom/dicom_parser.h"
#include "dicom/dicom_series.h"

namespace c3de::imaging {

/// Segments with their names (Segment Label) and colours (Recommended Display CIELab Value). None: unknown type.
[[nodiscard]] std::optional<DicomSegmentation> segmentationOf(const DicomSet &set);

/// Recommended Display CIELab Value, PS3.3 C.10.7.1.1 (white is D50), to linear RGB.
[[nodiscard]] std::array<float, 3> colourOfLab(const std::vector<std::uint16_t> &lab);

/// The grid that contains all frames of a segmentation; positions without a frame are empty slices of it.
struct SegmentGrid {
  VolumeGeometry geometry;
  std::vector<std::size_t> k;  ///< of each slice of the stack
};
[[nodiscard]] Expected<SegmentGrid> gridOfSegments(const DicomFolder &folder, const DicomStack &stack);

/// Segments as labels, by their numbers. Overlapping segments go to further layers, in the order of their numbers, each
/// to the first layer where it fits. A fraction belongs to its segment from one half on.
[[nodiscard]] Expected<LoadedLabels> readSegments(const DicomFolder &folder, const DicomStack &stack,
                                                  const ReadOptions &options);

}  // namespace c3de::imaging
