// SPDX-License-Identifier: Apache-2.0
// From files to stacks of parallel slices, and from a stack to a plan of a volume.
#pragma once

#include "c3de/imaging/reading.h"
#include "dicom/dicom_files.h"

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

/// Slices that follow each other at one distance, among others at another one.
struct SliceBlock {
  std::size_t first = 0, count = 0;  ///< of the places along k
  double spacing_mm = 0.0;
};
/// Cuts a row of places into blocks of at least three slices; empty where it is not made of two or more.
/// @param along  mm, ascending
[[nodiscard]] std::vector<SliceBlock> blocksIn(const std::vector<double> &along);
/// The blocks of a stack as stacks of their own; empty where it is one block.
[[nodiscard]] std::vector<DicomStack> blocksOf(const DicomFolder &folder, const DicomStack &stack);

/// Reads the headers of all files below a folder (nine levels deep), or of those beside a file.
[[nodiscard]] Expected<DicomFolder> scanDicom(const std::filesystem::path &path, const ProgressFn &progress);

/// Slices in their order along k, one for each place, and where the volume lies.
struct StackPlan {
  std::vector<SliceRef> slices;
  std::vector<double> at;  ///< of each slice, in voxels of the volume along k
  bool resampled = false;  ///< the volume has other slices than these
  std::size_t times = 1;   ///< pictures at every place
  VolumeGeometry geometry;
  std::vector<std::string> notices;
};

/// @param preferred  of several pictures at one place take that of this file, if it is one of them and the time is 0
/// @param time  which of several pictures at one place, from 0
[[nodiscard]] Expected<StackPlan> planStack(const DicomFolder &folder, const DicomStack &stack,
                                            const std::filesystem::path &preferred, std::size_t time);

/// Decodes what a plan names.
[[nodiscard]] Expected<LoadedVolume> readStack(const DicomFolder &folder, const DicomStack &stack,
                                               const StackPlan &plan, const ReadOptions &options);

/// What reading.h promises, for DICOM.
[[nodiscard]] Expected<LoadedVolume> readDicom(const std::filesystem::path &path, const ReadOptions &options);
/// Labels of a segmentation; nothing where the path leads to an image of numbers, which readDicom() reads.
[[nodiscard]] Expected<std::optional<LoadedLabels>> readDicomSegments(const std::filesystem::path &path,
                                                                      const ReadOptions &options);
[[nodiscard]] Expected<std::vector<SeriesInfo>> listDicom(const std::filesystem::path &path,
                                                          const ProgressFn &progress);
/// ProgressFn for a part of the whole; it refers to `progress`.
[[nodiscard]] ProgressFn partOf(const ProgressFn &progress, double from, double to);

}  // namespace c3de::imaging
