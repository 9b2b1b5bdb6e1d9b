// SPDX-License-Identifier: Apache-2.0
// The phantom with the letters L, A and S, in the renderer's format.
#pragma once

#include "c3de/render/image_renderer.h"
#include "support/letter_phantom.h"

namespace c3de::render::test {

using c3de::test::kAir, c3de::test::kBlock, c3de::test::kInk, c3de::test::letterRows;

struct Phantom : c3de::test::LetterPhantom {
  [[nodiscard]] ImageVoxels image() const { return {place(), VoxelType::int16, voxels.data(), 1.0, 0.0}; }
  [[nodiscard]] GridGeometry place() const { return {size, worldFromIndex}; }
};

inline Phantom makePhantom(std::array<std::size_t, 3> size, const Mat4 &worldFromIndex) {
  return {c3de::test::letterPhantom(size, worldFromIndex)};
}

/// 1 mm voxels, axes along the world's.
inline Phantom plainPhantom() {
  const c3de::test::LetterGrid plain = c3de::test::letterGrids().front();
  return makePhantom(plain.size, plain.worldFromIndex);
}

}  // namespace c3de::render::test
