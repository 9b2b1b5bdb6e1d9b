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

/// Options of the readers. All functions here may run on any thread, several at a time.
struct ReadOptions {
  /// For a folder with several series: SeriesInfo::id, number or description; empty: the only one
  std::string series;
  std::size_t time = 0;         ///< of several time points, from 0
  ProgressFn progress;          ///< returning false ends the reading with ErrorCode::cancelled
  std::size_t memoryLimit = 0;  ///< maximum bytes of memory at peak; 0: the free memory of the machine
};

struct LoadedVolume {
  Volume volume;
  std::size_t times = 1;             ///< number of time points stated in the file; one of them is `volume`
  std::vector<std::string> notices;  ///< sentences for the user: assumptions, omissions, resampling
};

struct LoadedLabels {
  LabelMap labels;
  std::vector<LabelMap> layers;  ///< further layers of a file whose labels overlap, each with its own labels
  std::vector<std::string> notices;
};

/// One stack of parallel slices of equal size, or one image file.
struct SeriesInfo {
  std::string id;  ///< for ReadOptions::series; does not identify the patient
  std::string description, modality;
  std::string number;                 ///< DICOM Series Number; empty: none
  std::string orientation;            ///< of the slices: "axial", "oblique sagittal", …; empty: unknown
  std::array<std::size_t, 3> size{};  ///< as found; missing slices are not counted
  std::size_t files = 0;
  std::size_t times = 1;  ///< time points available to ReadOptions::time
  bool isPart = false;    ///< of the previous series, which is read unless this one is requested
  /// Input for readLabelMap(): DICOM segmentation, or with segments of 3D Slicer or a NIfTI label table. For DICOM,
  /// readVolume() chooses it only if there is nothing else.
  bool isSegmentation = false;
  bool holdsNamedFile = false;  ///< the file passed to listSeries() belongs to it
  std::filesystem::path folder;
  std::string refusal;      ///< why readVolume() would refuse it; empty: it would try
  std::string patientName;  ///< display only at the user's request; it is in no message, notice or log
};

/// Reads DICOM (a folder with its sub-folders, or any file of a series), NIfTI-1 and -2, NRRD and NHDR, MetaImage. The
/// stored scalar type is retained, slope and intercept are not applied; 64-bit integers become 32-bit where they fit.
/// Sheared grids (gantry tilt) are retained. Unevenly spaced slices are resampled between their neighbours with a
/// notice, and blocks of different spacing to that of the finest; each block is also available as a part of its series.
/// Of several time points the requested one is read (DICOM: for 0 that of the named file). A file that ends within
/// later ones is read with a notice of how many are complete. Colours (three or four integers of 8 or 16 bits; those of
/// DICOM) become Volume::colours and their luma. Errors (input): unreadable, truncated or damaged files, unknown header
/// fields (NRRD), a series or a time point that does not exist, images of other vectors, slices that do not form a
/// volume, several series and none chosen (the message lists them), more memory needed than allowed (the message states
/// both figures).
[[nodiscard]] Expected<LoadedVolume> readVolume(const std::filesystem::path &path, const ReadOptions &options = {});

/// Reads integers from 0 as labels. With a notice: values off by up to 0.01 are rounded, non-finite values and one
/// negative value are background, numbers above 65535 get free ones. Names and colours come from the file (segments of
/// NRRD; the label table that Connectome Workbench and TotalSegmentator store in NIfTI) or a table next to it: for
/// a.nii.gz that is a.nii.txt, a.nii.label, a.label, a.txt or a.ctbl with lines of `number name`, of ITK-SNAP or of
/// Slicer. A single unnamed label gets its name from the file (nameFromFile()). Overlapping segments of 3D Slicer or
/// DICOM are stored in layers, of which the first is `labels` and the others are `layers`. A segment is in one layer;
/// its number may occur in several (3D Slicer). A folder without DICOM whose files are masks is a label map of these,
/// named after their files.
[[nodiscard]] Expected<LoadedLabels> readLabelMap(const std::filesystem::path &path, const ReadOptions &options = {});

/// The series of a DICOM folder (including sub-folders), of the folder of a DICOM file, or the one image of another
/// file.
[[nodiscard]] Expected<std::vector<SeriesInfo>> listSeries(const std::filesystem::path &path,
                                                           const ProgressFn &progress = {});

/// Whether readVolume() is worth trying: by extension, by the first bytes, or for a folder by its files. Fast.
[[nodiscard]] bool isLikelyImage(const std::filesystem::path &path);

}  // namespace c3de::imaging
