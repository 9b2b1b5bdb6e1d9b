// SPDX-License-Identifier: Apache-2.0
// Arrays compressed by vtkZLibDataCompressor (VTK file formats, "XML file formats", compressed data): a header of
// integers [blocks][size of a block][size of the last one, 0: full][packed size of each block], then the blocks.
#pragma once

#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

struct PackedArray {
  std::string_view source;      ///< from the header on; anything after the last block is ignored
  bool isBase64 = false;        ///< header and blocks are encoded separately, one after the other
  std::size_t headerBytes = 4;  ///< of a number in the header: 4 or 8
  bool isBigEndian = false;
};

/// The bytes of the array. Sizes in a header are limited to what the packed bytes can contain. Errors (input): the
/// source ends too early, an impossible size, a block that does not inflate to its size.
[[nodiscard]] Expected<std::string> unpacked(const PackedArray &array);

}  // namespace c3de::geometry
