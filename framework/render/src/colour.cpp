// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "c3de/render/renderer.h"

namespace c3de::render {

Colour displayColour(const std::array<float, 3> &linear, float opacity) {
  const auto encoded = [](float c) { return c < 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f; };
  return {encoded(linear[0]), encoded(linear[1]), encoded(linear[2]), opacity};
}

}  // namespace c3de::render
