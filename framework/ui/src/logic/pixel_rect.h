// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::ui {

/// In window pixels, from the upper left corner.
struct PixelRect {
  float x = 0, y = 0, w = 0, h = 0;
  [[nodiscard]] bool isEmpty() const { return w < 1.0f || h < 1.0f; }
  [[nodiscard]] bool contains(double px, double py) const { return px >= x && py >= y && px < x + w && py < y + h; }
};

}  // namespace c3de::ui
