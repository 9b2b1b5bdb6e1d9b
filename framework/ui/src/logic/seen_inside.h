// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/render/camera.h"
#include "c3de/render/image_renderer.h"

namespace c3de::ui {

/// How far along a ray, mm, the inside of bodies is seen: the first slice that is shown as a plane in space, or opaque
/// mesh that lies inside of one. Nothing: it meets none, or another opaque mesh before. Looks at every triangle that is
/// shown: for a press, not for every move of the mouse.
/// @param place  of the image; null: there is none
/// @param ray    world, unit direction; begins within what cuts have left
[[nodiscard]] std::optional<double> seenInside(const render::Renderer &renderer, const render::ImageScene &scene,
                                               const render::GridPlace *place, const render::Ray &ray);

}  // namespace c3de::ui
