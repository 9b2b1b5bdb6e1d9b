// SPDX-License-Identifier: Apache-2.0
// From files to stacks of parallel slices, and from a stack to a plan of a volume.
#pragma once

#include "c3de/imaging/reading.h"
#include "dicom_files.h"

namespace c3de::imaging {

/// One frame of one file.
struct SliceRef {
  std::size_t file = 0, frame = 0;
};

/// Frames of one series in one folder with equal size, spacing and orientation.
struct DicomStack {
  SeriesInfo info;
  std::vector<SliceRef> slices;  ///< in no order
};

struct DicomFolder {
  std::vector<DicomFile> files;
  std::vector<DicomStack> stacks;
  std::size_t others = 0;  ///< files that are no DICOM image
};

/// Reads the headers of all files below a folder (nine levels deep), or of those beside a file.
[[nodiscard]] Expected<DicomFolder> scanDicom(const std::filesystem::path &path, const ProgressFn &progress);

/// Slices in their order along k, one for each place, and where the volume lies.
struct StackPlan {
  std::vector<SliceRef> slices;
  std::vector<double> at;      ///< of each slice, in voxels of the volume along k
  bool resampled = false;      ///< the volume has other slices than these
  VolumeGeometry geometry;
  std::vector<std::string> notices;
};

/// @param preferred  of several pictures at one place take that of this file, if it is one of them
[[nodiscard]] Expected<StackPlan> planStack(const DicomFolder &folder, const DicomStack &stack,
                                            const std::filesystem::path &preferred);

/// Decodes what a plan names.
[[nodiscard]] Expected<LoadedVolume> readStack(const DicomFolder &folder, const DicomStack &stack, const StackPlan &plan,
                                               const ReadOptions &options);

}  // namespace c3de::imaging
