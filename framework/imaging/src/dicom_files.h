// SPDX-License-Identifier: Apache-2.0
// What the headers of DICOM files say about their frames, and their pixels; GDCM stays behind this header.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// One picture of a file.
struct DicomFrame {
  std::optional<Vec3> position;         ///< centre of its first pixel, LPS mm
  bool oriented = false;
  Vec3 alongRow{1, 0, 0}, alongColumn{0, 1, 0};  ///< unit vectors of growing column and row index
  double columnStep = 1.0, rowStep = 1.0;        ///< mm between columns, between rows
  bool spaced = false;
  double sliceStep = 0.0;                        ///< mm to the next slice as stated; 0: not stated
  double slope = 1.0, intercept = 0.0;
  double time = 0.0;                             ///< orders frames at one place
};

struct DicomFile {
  std::filesystem::path path;
  std::string series, instance, description, modality, patientName, unit;
  std::size_t rows = 0, columns = 0;
  unsigned bits = 0;
  bool isSigned = false;
  std::string refusal;               ///< why its frames make no volume; empty: none known
  std::vector<std::string> notices;
  std::vector<double> order;         ///< temporal position, echo, acquisition, instance
  std::vector<DicomFrame> frames;
};

/// Whether the file begins as DICOM does.
[[nodiscard]] bool isDicom(const std::filesystem::path &path);

/// Reads a header without its pixels; nothing for what is no DICOM image (reports, plans, directories, other files).
[[nodiscard]] std::optional<DicomFile> readDicomHeader(const std::filesystem::path &path);

/// Decodes all frames of a file. Stored values, one after the other, in the type they decode to.
struct DicomPixels {
  std::size_t rows = 0, columns = 0, frames = 0;
  Voxels voxels;
};
[[nodiscard]] Expected<DicomPixels> decodeDicom(const std::filesystem::path &path);

}  // namespace c3de::imaging
