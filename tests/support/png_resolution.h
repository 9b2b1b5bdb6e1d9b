// SPDX-License-Identifier: Apache-2.0
// What a PNG file states about its size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace c3de::test {

struct PngSize {
  std::uint32_t width = 0, height = 0;
  std::uint32_t perMetreX = 0, perMetreY = 0, unit = 0, crc = 0;  ///< of the chunk pHYs; 0: there is none
  bool isBeforeData = false;                                      ///< pHYs is before IDAT, as it must be
};

/// Nothing if the bytes are no PNG file, or a chunk exceeds them.
inline std::optional<PngSize> pngSize(const std::string &bytes) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  if (bytes.substr(0, 8) != "\x89PNG\r\n\x1a\n") return std::nullopt;
  PngSize size;
  bool hasData = false;
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = number(at);
    const std::string type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - 12) return std::nullopt;
    if (type == "IHDR") {
      size.width = number(at + 8);
      size.height = number(at + 12);
    } else if (type == "pHYs" && length == 9) {
      size.perMetreX = number(at + 8);
      size.perMetreY = number(at + 12);
      size.unit = static_cast<unsigned char>(bytes[at + 16]);
      size.crc = number(at + 17);
      size.isBeforeData = !hasData;
    } else if (type == "IDAT") {
      hasData = true;
    }
    if (type == "IEND") return at + 12 == bytes.size() ? std::optional(size) : std::nullopt;
    at += length + 12;
  }
  return std::nullopt;
}

}  // namespace c3de::test
