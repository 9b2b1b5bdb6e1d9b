// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "support/catch.h"

namespace test_files {

/// Writes bytes to a file in the case's own folder.
inline std::filesystem::path write(const std::string &name, std::string_view bytes) {
  const auto folder = testOutputFolder();
  std::ofstream out(folder / name, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return folder / name;
}

/// A tetrahedron of 10 mm, faces outwards.
inline constexpr std::string_view kTetrahedronObj =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

inline bool contains(const std::vector<std::string> &lines, const std::string &part) {
  for (const std::string &line : lines)
    if (line.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace test_files
