// SPDX-License-Identifier: Apache-2.0
// Frames and pixels of DICOM files as described by their headers; hides GDCM.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// One frame of a file.
struct DicomFrame {
  std::optional<Vec3> position;  ///< centre of its first pixel, LPS mm
  bool oriented = false;
  Vec3 alongRow{1, 0, 0}, alongColumn{0, 1, 0};  ///< unit vectors of increasing column and row index
  double columnStep = 1.0, rowStep = 1.0;        ///< mm between columns, between rows
  bool spaced = false;
  double sliceStep = 0.0;  ///< mm to the next slice as stated; 0: not stated
  double slope = 1.0, intercept = 0.0;
  double time = 0.0;          ///< orders frames at one position
  std::uint16_t segment = 0;  ///< number of the segment that a frame of a segmentation holds
};

/// The attributes of one segment of a segmentation.
struct DicomSegment {
  std::uint16_t number = 0;
  std::string name;
  bool coloured = false;
  std::array<float, 3> colour{};  ///< linear RGB
};

/// DICOM segmentation, PS3.3 C.8.20.
struct DicomSegmentation {
  enum class Kind { binary, fractional, labels };  ///< one bit; 0 … maximum; segment numbers
  Kind kind = Kind::binary;
  double most = 1.0;
  std::vector<DicomSegment> segments;
};

struct DicomFile {
  std::filesystem::path path;
  std::string series, number, instance, description, modality, patientName, unit;
  std::size_t rows = 0, columns = 0;  ///< of a frame
  std::size_t tiles = 0;              ///< frames tiled in one picture (mosaic); 0: none
  unsigned bits = 0;
  bool isSigned = false, isReal = false;          ///< floating-point numbers
  bool isColoured = false, isTimeSeries = false;  ///< frames without positions are one position at several times
  std::optional<DicomSegmentation> segmentation;
  std::string refusal;  ///< why its frames do not form a volume; empty: no reason known
  std::vector<std::string> notices;
  std::vector<double> order;  ///< temporal position, echo, acquisition, instance
  std::vector<DicomFrame> frames;
};

/// Whether the file is DICOM by its signature, or a DICOM image without it.
[[nodiscard]] bool isDicom(const std::filesystem::path &path);

/// Where to search for the images of a path: the folder of a DICOMDIR, otherwise the path itself.
[[nodiscard]] std::filesystem::path imageFolderOf(const std::filesystem::path &path);

/// Reads a header without its pixels; none for files that are not DICOM images (reports, plans, directories, others).
[[nodiscard]] std::optional<DicomFile> readDicomHeader(const std::filesystem::path &path);

/// Decodes all frames of a file. Stored values, frame after frame, in the type they decode to; one byte per bit. For
/// colours their luma. Mosaics are not split.
struct DicomPixels {
  std::size_t rows = 0, columns = 0, frames = 0;
  Voxels voxels;
  std::vector<Rgba> colours;
};
[[nodiscard]] Expected<DicomPixels> decodeDicom(const std::filesystem::path &path);

}  // namespace c3de::imaging
