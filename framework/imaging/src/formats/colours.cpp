// SPDX-License-Identifier: Apache-2.0
#include "formats/colours.h"

#include <algorithm>
#include <cmath>

namespace c3de::imaging {
namespace {

template <class T>
std::uint8_t eightBits(T x) {
  if constexpr (sizeof(T) == 2) return static_cast<std::uint8_t>((static_cast<unsigned>(x) + 128u) / 257u);
  return static_cast<std::uint8_t>(x);
}

}  // namespace

void setColours(Volume &volume, const Voxels &numbers, std::size_t channels) {
  const std::size_t count = volume.geometry.voxelCount();
  std::vector<std::uint8_t> luma(count);
  volume.colours.assign(count, {0, 0, 0, 255});
  std::visit(
      [&](const auto &all) {
        for (std::size_t v = 0; v < count; ++v) {
          Rgba &colour = volume.colours[v];
          for (std::size_t c = 0; c < channels; ++c) colour[c] = eightBits(all[v * channels + c]);
          luma[v] =
              static_cast<std::uint8_t>(std::lround(0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2]));
        }
      },
      numbers);
  volume.voxels = std::move(luma);
}

}  // namespace c3de::imaging
