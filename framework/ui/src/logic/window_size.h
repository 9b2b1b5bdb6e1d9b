// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace c3de::ui {

/// The size to request so that a window, after enlargement by the scale of its screen, fits into the screen's work
/// area.
/// @param wanted  window units, before the enlargement
/// @param room    pixels of the work area; 0 or less: unknown, no limit
/// @param scale   pixels per window unit; not finite or not above 0: 1
[[nodiscard]] std::array<int, 2> sizeThatFits(std::array<int, 2> wanted, std::array<int, 2> room,
                                              std::array<float, 2> scale);

}  // namespace c3de::ui
