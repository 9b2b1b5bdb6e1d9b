// SPDX-License-Identifier: Apache-2.0
// An image that shows when it is turned or mirrored: a grey block with letters embossed at the sides L, A and S.
#pragma once

#include <string_view>
#include <vector>

#include "c3de/render/image_renderer.h"

namespace c3de::render::test {

struct Phantom {
  std::array<std::size_t, 3> size{};
  Mat4 worldFromIndex = kIdentity4;
  std::vector<std::int16_t> voxels;
  std::vector<std::uint16_t> labels;  ///< 1: block, 2: letters

  [[nodiscard]] ImageVoxels image() const { return {{size, worldFromIndex}, VoxelType::int16, voxels.data(), 1.0, 0.0}; }
  [[nodiscard]] GridPlace place() const { return {size, worldFromIndex}; }
};

/// Seven rows of five pixels, '#' for ink.
inline std::array<std::string_view, 7> letterRows(char letter) {
  switch (letter) {
    case 'L': return {"#....", "#....", "#....", "#....", "#....", "#....", "#####"};
    case 'A': return {".###.", "#...#", "#...#", "#####", "#...#", "#...#", "#...#"};
    default: return {".####", "#....", "#....", ".###.", "....#", "....#", "####."};
  }
}

constexpr std::int16_t kAir = -1000, kBlock = 40, kInk = 700;

/// Half of the sides of the block are 30 mm; letters of 3 mm pixels are 20 to 26 mm from the centre. World LPS: +x is L,
/// -y is A, +z is S. L reads right seen from the left with S up, A seen from the front with S up, S seen from the feet
/// with the front up, as in an axial view.
/// @param worldFromIndex  voxels are found at their world points, so that any grid shows the same thing
inline Phantom makePhantom(std::array<std::size_t, 3> size, const Mat4 &worldFromIndex) {
  Phantom p{size, worldFromIndex, {}, {}};
  const auto inkAt = [](char letter, double right, double up) {
    const double column = right / 3.0 + 2.5, row = 3.5 - up / 3.0;
    if (column < 0 || column >= 5 || row < 0 || row >= 7) return false;
    return letterRows(letter)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#';
  };
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i) {
        const Vec3 x = transformPoint(worldFromIndex, {double(i), double(j), double(k)});
        const bool isBlock = std::abs(x[0]) <= 30 && std::abs(x[1]) <= 30 && std::abs(x[2]) <= 30;
        const auto isAt = [](double depth) { return depth >= 20 && depth <= 26; };
        // Seen from the left, the front of the patient is on the left of the screen.
        const bool isInk = isBlock && ((isAt(x[0]) && inkAt('L', x[1], x[2])) || (isAt(-x[1]) && inkAt('A', x[0], x[2])) ||
                                       (isAt(x[2]) && inkAt('S', x[0], -x[1])));
        p.voxels.push_back(isInk ? kInk : isBlock ? kBlock : kAir);
        p.labels.push_back(isInk ? 2 : isBlock ? 1 : 0);
      }
  return p;
}

/// 1 mm voxels, axes along the world's.
inline Phantom plainPhantom() {
  return makePhantom({72, 72, 72}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -35.5, -35.5, -35.5, 1});
}

}  // namespace c3de::render::test
