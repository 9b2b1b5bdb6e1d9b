// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Text in the head of every file that is written.
inline constexpr std::string_view kFrameText = "SPACE=LPS UNITS=mm";

/// Information about the numbers of a mesh file from comments in its head.
struct FrameComment {
  std::optional<LengthUnit> unit;  ///< "UNITS=mm", "Unit: millimeters" and similar; for glTF always metres
  std::string unknownUnit;         ///< a stated unit that is not supported, in lower case
  bool isRas = false;              ///< "SPACE=RAS": x to the right, y to the front; otherwise LPS is assumed
};

/// Examines comments only (the unit of glTF is defined by its standard): `#` lines of OBJ and OFF, the 80 bytes or the
/// first line of STL, comments of PLY and XML, the title of legacy VTK. @param extension  lower case with the dot
[[nodiscard]] FrameComment frameComment(std::string_view text, std::string_view extension);
/// Same for a file, of which only the beginning is read; nothing is stated if it cannot be read.
[[nodiscard]] FrameComment frameCommentOf(const std::filesystem::path &path);

}  // namespace c3de::geometry
