// SPDX-License-Identifier: Apache-2.0
// Input of a view in the form passed to tools.
#pragma once

#include <optional>

#include "c3de/ui/image_views.h"
#include "c3de/ui/view_controller.h"

namespace c3de::ui {

/// @param type     C3DE_EVENT_*
/// @param buttons  all that are down
/// @param ray      through the pixel, unit direction
/// @param view     unit, viewing direction
[[nodiscard]] c3de_event toolEvent(const ViewInput &input, std::uint32_t type, std::uint32_t buttons,
                                   const render::Ray &ray, const Vec3 &view);
/// The slice of an event; nothing for the 3D view.
[[nodiscard]] std::optional<Pane> slicePaneOf(const c3de_event &event);

}  // namespace c3de::ui
