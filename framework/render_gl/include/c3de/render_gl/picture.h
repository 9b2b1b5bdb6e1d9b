// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// The image that `paint` draws into the framebuffer bound while it runs, which has a depth buffer, is multisampled and
/// initially black. Needs a current OpenGL context. Errors: a side below 1 pixel or above the device's limit,
/// insufficient graphics memory.
[[nodiscard]] Expected<Image> paintPicture(int width, int height, const std::function<void()> &paint);

/// Longest side of such an image, pixels: the limit of the device. Needs a current OpenGL context.
[[nodiscard]] int largestPictureSide();

}  // namespace c3de::render
