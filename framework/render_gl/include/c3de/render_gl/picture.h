// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// What `paint` draws into the framebuffer that is bound while it runs, which has depth, smooths edges and begins
/// black. Needs a current OpenGL context. Errors: a side below 1 pixel or above what the device draws, no graphics
/// memory.
[[nodiscard]] Expected<Image> paintPicture(int width, int height, const std::function<void()> &paint);

}  // namespace c3de::render
