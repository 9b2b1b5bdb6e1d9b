// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/render/camera.h"
#include "c3de/render/image_renderer.h"

namespace c3de::ui {

/// How far along a ray, mm, the inside of bodies is visible: the first slice shown as a plane in space, or opaque mesh
/// inside a body. Nothing if the ray meets neither, or meets another opaque mesh before. Tests every displayed
/// triangle: for a press, not for every mouse move.
/// @param place  of the image; null if there is none
/// @param ray    world, unit direction; starts inside the part that the cuts leave
[[nodiscard]] std::optional<double> seenInside(const render::Renderer &renderer, const render::ImageScene &scene,
                                               const render::GridGeometry *place, const render::Ray &ray);

/// How far along a ray, mm, the nearest mesh is hit, opaque or not; nothing if none is. For a press, as above.
[[nodiscard]] std::optional<double> nearestSurface(const render::Renderer &renderer, const render::Ray &ray);

}  // namespace c3de::ui
