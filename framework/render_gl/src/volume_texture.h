// SPDX-License-Identifier: Apache-2.0
// Grids in graphics memory.
#pragma once

#include <span>
#include <string>

#include "gl_objects.h"
#include "retained_images.h"

namespace c3de::render {

/// One texture of a grid, plus the colour table for labels, the colours on the same grid for colour images, or a field
/// on it for displacements.
struct GridTexture final : BackEndData {
  Texture grid = Texture::create();
  Texture table = Texture::create();
  Texture colours{};
  Texture field{};  ///< on the grid of a displacement
};

/// Integers (16 bits or less) keep their precision, everything else becomes single precision.
[[nodiscard]] Expected<void> uploadGreyValues(ImageSlot &slot, const ImageVoxels &image, std::string *notice);
[[nodiscard]] Expected<void> uploadLabelValues(ImageSlot &slot, std::span<const std::uint16_t> voxels);
/// The texture is created once; later calls replace its contents.
[[nodiscard]] Expected<void> uploadDisplacementValues(ImageSlot &slot, std::span<const float> xyz_mm,
                                                      std::span<const float> gap_mm);
/// Pairs for an uploaded displacement; empty: removes the field.
[[nodiscard]] bool uploadFieldValues(ImageSlot &slot, std::span<const float> pairs);
void uploadLabelTable(ImageSlot &slot);

/// A row of colours, interpolated linearly.
void uploadColourRow(const Texture &texture, std::span<const std::array<float, 4>> colours);

}  // namespace c3de::render
