// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::session {

/// A point of a landmark file.
struct FileLandmark {
  std::string name;
  Vec3 lps_mm{};
  std::string where;  ///< "FILE:LINE", or the point of a JSON file; prefix of messages
};

/// A landmark as it is written: where it was at rest and where it is now.
struct WrittenLandmark {
  std::string name;
  Vec3 reference_mm{}, position_mm{};  ///< LPS
};

/// Maximum number of landmarks in a file.
inline constexpr std::size_t kMaxLandmarks = 10000;

/// Whether the file name has an extension of landmarks: `.csv`, `.fcsv` or `.mrk.json`.
[[nodiscard]] bool isLandmarkPath(const std::filesystem::path &file);
/// ErrorCode::usage, which states the accepted extensions. @param option  prefix of the message
[[nodiscard]] Expected<void> checkLandmarkPath(const std::filesystem::path &file, const std::string &option);

/// Reads landmarks by the extension of the file. CSV has the columns `name`, `x_mm`, `y_mm`, `z_mm` in any order, in
/// LPS; other columns are ignored. `.fcsv` and `.mrk.json` are fiducials of 3D Slicer; they state RAS or LPS. Points of
/// `.mrk.json` that have not been placed are omitted. Errors (ErrorCode::input) state file, place, value and what is
/// accepted: a number that is not finite, a name that is empty or not unique, another coordinate system or unit.
/// @threads any
[[nodiscard]] Expected<std::vector<FileLandmark>> readLandmarks(const std::filesystem::path &file);

/// Writes landmarks by the extension of the file: CSV with the positions at rest and at present, which readLandmarks()
/// reads as those at rest; `.fcsv` and `.mrk.json` with the present positions, in LPS. Errors: ErrorCode::output.
[[nodiscard]] Expected<void> writeLandmarks(const std::filesystem::path &file,
                                            std::span<const WrittenLandmark> landmarks);

}  // namespace c3de::session
