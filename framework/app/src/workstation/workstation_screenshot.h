// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/render/camera.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::app {

/// Writes the 3D view as PNG: `out/c3de-DATE-TIME.png` in the current folder, or in the user's data folder if that is
/// not writable. Returns the file.
[[nodiscard]] Expected<std::filesystem::path> saveViewScreenshot(render::Renderer &renderer,
                                                                 const render::Camera &camera, int width, int height);

}  // namespace c3de::app
