// SPDX-License-Identifier: Apache-2.0
// Input of a view as tools get it.
#pragma once

#include "c3de/ui/view_controller.h"

namespace c3de::ui {

/// @param type     C3DE_EVENT_*
/// @param buttons  all that are down
/// @param ray      through the pixel, unit direction
/// @param view     unit, where the view looks
[[nodiscard]] c3de_event toolEvent(const ViewInput &input, std::uint32_t type, std::uint32_t buttons,
                                   const render::Ray &ray, const Vec3 &view);

}  // namespace c3de::ui
