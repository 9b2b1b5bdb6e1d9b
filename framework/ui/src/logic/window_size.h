// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace c3de::ui {

/// The size to ask for so that a window, enlarged by the scale of its screen, is no larger than what the screen has
/// room for.
/// @param wanted  window units, before the enlargement
/// @param room    pixels of the work area; 0 or less: not known, no limit
/// @param scale   pixels per window unit; not finite or not above 0: 1
[[nodiscard]] std::array<int, 2> sizeThatFits(std::array<int, 2> wanted, std::array<int, 2> room,
                                              std::array<float, 2> scale);

}  // namespace c3de::ui
