// SPDX-License-Identifier: Apache-2.0
// Real label maps without the reader under test: NIfTI-1, compressed, whole numbers or float, geometry from the sform.
#pragma once

#include <zlib.h>

#include <cstring>
#include <filesystem>

#include "c3de/imaging/volume.h"

namespace label_files {

inline c3de::imaging::LabelMap read(const std::filesystem::path &path) {
  std::vector<unsigned char> bytes;
  gzFile file = gzopen(path.string().c_str(), "rb");
  std::vector<unsigned char> chunk(1u << 20);
  for (int got = 0; file != nullptr && (got = gzread(file, chunk.data(), static_cast<unsigned>(chunk.size()))) > 0;)
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + got);
  if (file != nullptr) gzclose(file);
  c3de::imaging::LabelMap out;
  const auto at = [&](std::size_t offset, auto value) {
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  if (bytes.size() < 352 || at(0, std::int32_t{}) != 348) return out;
  for (std::size_t a = 0; a < 3; ++a) out.geometry.size[a] = static_cast<std::size_t>(at(42 + 2 * a, std::int16_t{}));
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      out.geometry.indexToWorld[4 * column + row] =
          (row < 2 ? -1.0 : 1.0) * static_cast<double>(at(280 + 16 * row + 4 * column, 0.0f));  // LPS from RAS
  const std::int16_t type = at(70, std::int16_t{});
  const auto first = static_cast<std::size_t>(at(108, 0.0f));
  out.voxels.resize(out.geometry.voxelCount());
  for (std::size_t v = 0; v < out.voxels.size(); ++v) {
    double value = 0.0;
    if (type == 2)
      value = bytes[first + v];
    else if (type == 4)
      value = at(first + 2 * v, std::int16_t{});
    else if (type == 8)
      value = at(first + 4 * v, std::int32_t{});
    else if (type == 16)
      value = static_cast<double>(at(first + 4 * v, 0.0f));
    out.voxels[v] = value > 0.0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
  }
  return out;
}

}  // namespace label_files
