// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// What every file that we write says in its head.
inline constexpr std::string_view kFrameText = "SPACE=LPS UNITS=mm";

/// What comments in the head of a mesh file say about its numbers.
struct FrameComment {
  std::optional<LengthUnit> unit;  ///< "UNITS=mm", "Unit: millimeters" and the like; of glTF always metres
  std::string unknownUnit;         ///< a unit that is said and not read here, in lower case
  bool isRas = false;              ///< "SPACE=RAS": x to the right, y to the front; else LPS is taken
};

/// Looks at comments alone (glTF has its unit by its standard): `#` lines of OBJ and OFF, the 80 bytes or the first line
/// of STL, comments of PLY and XML, the title of legacy VTK. @param extension  lower case with the dot
[[nodiscard]] FrameComment frameComment(std::string_view text, std::string_view extension);
/// The same for a file, of which it reads the beginning; nothing said where it cannot be read.
[[nodiscard]] FrameComment frameCommentOf(const std::filesystem::path &path);

}  // namespace c3de::geometry
