// SPDX-License-Identifier: Apache-2.0
// Arrays that vtkZLibDataCompressor packed (VTK file formats, "XML file formats", compressed data): a header of whole
// numbers [blocks][size of a block][size of the last one, 0: full][packed size of each block], then the blocks.
#pragma once

#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

struct PackedArray {
  std::string_view source;      ///< from the header on; what is behind the last block is not looked at
  bool isBase64 = false;        ///< header and blocks are encoded one after the other
  std::size_t headerBytes = 4;  ///< of a number of the header: 4 or 8
  bool isBigEndian = false;
};

/// The bytes of the array. What a header claims is taken only as far as the packed bytes can hold it. Errors (input):
/// the source ends too early, a size that cannot be, a block that does not inflate to its size.
[[nodiscard]] Expected<std::string> unpacked(const PackedArray &array);

}  // namespace c3de::geometry
