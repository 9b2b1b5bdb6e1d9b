// SPDX-License-Identifier: Apache-2.0
// An image that reveals rotation and mirroring: a grey block with letters embossed at the sides L, A and S.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::test {

struct LetterPhantom {
  std::array<std::size_t, 3> size{};
  Mat4 worldFromIndex = kIdentity4;
  std::vector<std::int16_t> voxels;
  std::vector<std::uint16_t> labels;  ///< 1: block, 2: letters
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

/// Position of a letter: the middle of its depth, and the directions of the reader's right and up. World LPS: +x is L,
/// -y is A, +z is S. L reads right seen from the left with S up, A seen from the front with S up, S seen from the feet
/// with the front up, as in an axial view. Seen from the left, the front of the patient is on the left of the screen.
struct LetterPlace {
  char letter;
  Vec3 middle, right, up;  ///< middle in mm, directions of length 1
};
inline constexpr std::array<LetterPlace, 3> kLetterPlaces{{{'L', {23, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                           {'A', {0, -23, 0}, {1, 0, 0}, {0, 0, 1}},
                                                           {'S', {0, 0, 23}, {1, 0, 0}, {0, -1, 0}}}};
constexpr double kLetterPixel = 3.0;                         ///< mm
constexpr double kHalfBlock = 30.0, kHalfLetterDepth = 3.0;  ///< mm

/// The block is centred at the origin.
/// @param worldFromIndex  voxels are evaluated at their world points, so that any grid shows the same object
inline LetterPhantom letterPhantom(std::array<std::size_t, 3> size, const Mat4 &worldFromIndex) {
  LetterPhantom p{size, worldFromIndex, {}, {}};
  const auto isInkAt = [](const Vec3 &x) {
    for (const LetterPlace &place : kLetterPlaces) {
      const double depth = dot(x, place.middle) / norm(place.middle) - norm(place.middle);
      const double column = dot(x, place.right) / kLetterPixel + 2.5, row = 3.5 - dot(x, place.up) / kLetterPixel;
      if (std::abs(depth) > kHalfLetterDepth || column < 0 || column >= 5 || row < 0 || row >= 7) continue;
      if (letterRows(place.letter)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] == '#') return true;
    }
    return false;
  };
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i) {
        const Vec3 x = transformPoint(worldFromIndex, {double(i), double(j), double(k)});
        const bool isBlock =
            std::abs(x[0]) <= kHalfBlock && std::abs(x[1]) <= kHalfBlock && std::abs(x[2]) <= kHalfBlock;
        const bool isInk = isBlock && isInkAt(x);
        p.voxels.push_back(isInk ? kInk : isBlock ? kBlock : kAir);
        p.labels.push_back(isInk ? 2 : isBlock ? 1 : 0);
      }
  return p;
}

struct LetterGrid {
  const char *name;
  std::array<std::size_t, 3> size;
  Mat4 worldFromIndex;
};
/// Each covers the whole block: plain; all axes reversed and exchanged; oblique, uneven spacing; left-handed and
/// sheared.
inline std::vector<LetterGrid> letterGrids() {
  const double c = std::cos(0.3), s = std::sin(0.3);
  return {{"plain", {72, 72, 72}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -35.5, -35.5, -35.5, 1}},
          {"exchanged", {72, 72, 72}, {0, 0, -1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 35.5, 35.5, 35.5, 1}},
          {"oblique",
           {130, 130, 70},
           {0.8 * c, 0.8 * s, 0, 0, -0.8 * s, 0.8 * c, 0, 0, 0, 0, 1.1, 0, -51.6 * (c - s), -51.6 * (c + s), -38.0, 1}},
          {"sheared", {80, 100, 80}, {-1, 0, 0, 0, 0, 0.9, 0, 0, 0, 0.2, 1, 0, 39.5, -53, -39.5, 1}}};
}

}  // namespace c3de::test
