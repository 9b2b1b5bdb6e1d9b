// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace pointbased {

using Rgba8 = std::array<std::uint8_t, 4>;  ///< sRGB and opacity

inline constexpr std::size_t kColours = 256;

/// Dark violet through blue and green to bright yellow. Equal steps of the value appear as equal steps of colour.
/// Lightness alone shows the order, so the map is readable in greyscale and with colour vision deficiency.
///
/// A curve in Oklab, evenly divided by its length: lightness 0.30 … 0.92, hue 305° … 105°, chroma 0.15, 0.10 in the
/// middle.
/// @source  own; Oklab: Ottosson, A perceptual color space for image processing, 2020
[[nodiscard]] const std::array<Rgba8, kColours> &colourMap();

/// Colour of a value in low … high. Values outside have the colour of the nearer end. Not a number has that of `high`.
[[nodiscard]] Rgba8 colourOf(double value, double low, double high);

}  // namespace pointbased
