// SPDX-License-Identifier: Apache-2.0
// Groups files into stacks of parallel slices, and plans a volume from a stack.
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
  std::vector<SliceRef> slices;  ///< unordered
};

struct DicomFolder {
  std::vector<DicomFile> files;
  std::vector<DicomStack> stacks;
  std::size_t others = 0;  ///< files that are not DICOM images
};

/// Consecutive slices at one distance, among others at another distance.
struct SliceBlock {
  std::size_t first = 0, count = 0;  ///< in the sorted positions along k
  double spacing_mm = 0.0;
};
/// Splits a row of positions into blocks of at least three slices; empty where it does not consist of two or more.
/// @param along  mm, ascending
[[nodiscard]] std::vector<SliceBlock> blocksIn(const std::vector<double> &along);
/// The blocks of a stack as separate stacks; empty where it is one block.
[[nodiscard]] std::vector<DicomStack> blocksOf(const DicomFolder &folder, const DicomStack &stack);

/// Reads the headers of all files below a folder (nine levels deep), or of those in the folder of a file.
[[nodiscard]] Expected<DicomFolder> scanDicom(const std::filesystem::path &path, const ProgressFn &progress);

/// Slices in their order along k, one for each position, and the grid of the volume.
struct StackPlan {
  std::vector<SliceRef> slices;
  std::vector<double> at;  ///< of each slice, in voxels of the volume along k
  bool resampled = false;  ///< the slices of the volume differ from these
  std::size_t times = 1;   ///< pictures at every position
  VolumeGeometry geometry;
  std::vector<std::string> notices;
};

/// @param preferred  among several pictures at one position, choose that of this file, if it is one of them and the
/// time is 0
/// @param time  which of several pictures at one position, from 0
[[nodiscard]] Expected<StackPlan> planStack(const DicomFolder &folder, const DicomStack &stack,
                                            const std::filesystem::path &preferred, std::size_t time);

/// Decodes the slices of a plan.
[[nodiscard]] Expected<LoadedVolume> readStack(const DicomFolder &folder, const DicomStack &stack,
                                               const StackPlan &plan, const ReadOptions &options);

/// Implements the contract of reading.h for DICOM.
[[nodiscard]] Expected<LoadedVolume> readDicom(const std::filesystem::path &path, const ReadOptions &options);
/// Labels of a segmentation; none where the path denotes an image of values, which readDicom() reads.
[[nodiscard]] Expected<std::optional<LoadedLabels>> readDicomSegments(const std::filesystem::path &path,
                                                                      const ReadOptions &options);
[[nodiscard]] Expected<std::vector<SeriesInfo>> listDicom(const std::filesystem::path &path,
                                                          const ProgressFn &progress);
/// ProgressFn for a part of the whole; it refers to `progress`.
[[nodiscard]] ProgressFn partOf(const ProgressFn &progress, double from, double to);

}  // namespace c3de::imaging
