// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

namespace c3de::session {

/// A mask that was picked in an image, with the colour of its label.
struct PickedMask {
  imaging::Mask mask;
  std::optional<std::array<float, 3>> colour;  ///< linear RGB
};

/// The exact grid and voxels as bytes, little-endian: eight voxels in a byte, i fastest.
[[nodiscard]] std::string maskBytes(const imaging::Mask &mask, const std::optional<std::array<float, 3>> &colour);
/// Errors (input): not such bytes, too few or too many, a grid without voxels or that is not finite.
[[nodiscard]] Expected<PickedMask> maskOfBytes(std::string_view bytes);

}  // namespace c3de::session
