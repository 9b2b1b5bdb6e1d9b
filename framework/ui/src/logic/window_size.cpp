// SPDX-License-Identifier: Apache-2.0
#include "logic/window_size.h"

#include <algorithm>
#include <cmath>

namespace c3de::ui {

std::array<int, 2> sizeThatFits(std::array<int, 2> wanted, std::array<int, 2> room, std::array<float, 2> scale) {
  for (std::size_t a = 0; a < 2; ++a) {
    const double enlarged = std::isfinite(scale[a]) && scale[a] > 0.0f ? static_cast<double>(scale[a]) : 1.0;
    if (room[a] > 0) wanted[a] = std::min(wanted[a], static_cast<int>(std::floor(room[a] / enlarged)));
    wanted[a] = std::max(wanted[a], 1);
  }
  return wanted;
}

}  // namespace c3de::ui
