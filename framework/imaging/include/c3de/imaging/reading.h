// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What a caller may ask of a reader. All functions here may run on any thread, several at a time.
struct ReadOptions {
  /// Of a folder with several: SeriesInfo::id, number or description; empty: the only one
  std::string series;
  std::size_t time = 0;         ///< of several time points, from 0
  ProgressFn progress;          ///< answering false ends the reading with ErrorCode::cancelled
  std::size_t memoryLimit = 0;  ///< bytes that reading may take at its peak; 0: what the machine has free
};

struct LoadedVolume {
  Volume volume;
  std::size_t times = 1;             ///< time points that the file says it has; one of them is `volume`
  std::vector<std::string> notices;  ///< sentences for a person: what was assumed, left out or resampled
};

struct LoadedLabels {
  LabelMap labels;
  std::vector<LabelMap> layers;  ///< further ones of a file whose labels overlap, each with labels of its own
  std::vector<std::string> notices;
};

/// One stack of parallel slices of equal size, or one image file.
struct SeriesInfo {
  std::string id;  ///< for ReadOptions::series; does not name the patient
  std::string description, modality;
  std::string number;                 ///< Series Number of DICOM; empty: none
  std::string orientation;            ///< of the slices: "axial", "oblique sagittal", …; empty: not known
  std::array<std::size_t, 3> size{};  ///< as found; missing slices are not counted
  std::size_t files = 0;
  std::size_t times = 1;  ///< time points that ReadOptions::time chooses from
  bool isPart = false;    ///< of the series before it, which is read unless this one is asked for
  /// For readLabelMap(): of DICOM, or with the segments of 3D Slicer or a label table of NIfTI. Of DICOM readVolume()
  /// takes it only where there is nothing else.
  bool isSegmentation = false;
  bool holdsNamedFile = false;  ///< the file that listSeries() was asked for is one of its files
  std::filesystem::path folder;
  std::string refusal;      ///< why readVolume() would not take it; empty: it would try
  std::string patientName;  ///< show it only where the user asks; it is in no message, notice or log
};

/// Reads DICOM (a folder with its sub-folders, or any file of a series), NIfTI-1 and -2, NRRD and NHDR, MetaImage.
/// The stored scalar type is kept, slope and intercept are not applied; 64-bit integers become 32-bit where they fit.
/// Sheared grids (gantry tilt) stay as they are; unevenly spaced slices are resampled between their neighbours with a
/// notice, and blocks of different spacing to that of the finest; each block is a part of its series as well. Of
/// several time points the one that is asked for is read (DICOM: for 0 that of the file that was named); a file that
/// ends within later ones is read with a notice of how many are whole. Colours (three or four whole numbers of 8 or 16
/// bits; those of DICOM) become Volume::colours and their luma. Errors (input): unreadable, truncated or damaged files,
/// fields of a header that the format does not know (NRRD), a series or a time point that is not there, images of other
/// vectors, slices that make no volume, several series and none chosen (the message lists them), more memory needed
/// than allowed (the message names both figures).
[[nodiscard]] Expected<LoadedVolume> readVolume(const std::filesystem::path &path, const ReadOptions &options = {});

/// Reads whole numbers from 0 as labels. With a notice: values off by up to 0.01 are rounded, what is not finite and one
/// negative value are background, numbers above 65535 get free ones. Names and colours come from the file (segments of NRRD; the label table
/// that Connectome Workbench and TotalSegmentator put into NIfTI) or a table beside it: for a.nii.gz that is a.nii.txt,
/// a.nii.label, a.label, a.txt or a.ctbl with lines of `number name`, of ITK-SNAP or of Slicer. A single label that
/// nobody named is called after the file (nameFromFile()). Segments of 3D Slicer or DICOM that overlap lie in layers,
/// of which the first is `labels` and the others are `layers`; a segment is in one of them, its number may be in
/// several (3D Slicer). A folder without DICOM whose files are masks is a label map of these, called after their files.
[[nodiscard]] Expected<LoadedLabels> readLabelMap(const std::filesystem::path &path, const ReadOptions &options = {});

/// The series of a DICOM folder (sub-folders included), of the folder of a DICOM file, or the one image of another
/// file.
[[nodiscard]] Expected<std::vector<SeriesInfo>> listSeries(const std::filesystem::path &path,
                                                           const ProgressFn &progress = {});

/// Whether readVolume() should be asked: by extension, by the first bytes, or for a folder by the files in it. Quick.
[[nodiscard]] bool looksLikeImage(const std::filesystem::path &path);

}  // namespace c3de::imaging
