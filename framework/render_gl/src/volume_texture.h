// SPDX-License-Identifier: Apache-2.0
// Grids in the graphics memory.
#pragma once

#include <span>
#include <string>

#include "gl_objects.h"
#include "retained_images.h"

namespace c3de::render {

/// One texture of a grid; for labels the table of their colours, for colour images their colours on the same grid, for
/// displacements a field on it.
struct GridTexture final : BackEndData {
  Texture grid = Texture::create();
  Texture table = Texture::create();
  Texture colours{};
  Texture field{};  ///< on the grid of a displacement
};

/// Integers keep their precision (16 bits and less), everything else becomes single precision.
[[nodiscard]] Expected<void> uploadGreyValues(ImageSlot &slot, const ImageVoxels &image, std::string *notice);
[[nodiscard]] Expected<void> uploadLabelValues(ImageSlot &slot, std::span<const std::uint16_t> voxels);
/// The texture is made once; later calls replace its contents.
[[nodiscard]] Expected<void> uploadDisplacementValues(ImageSlot &slot, std::span<const float> xyz_mm,
                                                      std::span<const float> gap_mm);
/// Pairs, of a displacement that has been uploaded; empty: it goes.
[[nodiscard]] bool uploadFieldValues(ImageSlot &slot, std::span<const float> pairs);
void uploadLabelTable(ImageSlot &slot);

/// A row of colours, linear in between.
void uploadColourRow(const Texture &texture, std::span<const std::array<float, 4>> colours);

}  // namespace c3de::render
