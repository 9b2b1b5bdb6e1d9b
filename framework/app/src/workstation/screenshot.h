// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/session/export_image.h"
#include "c3de/session/preparation.h"
#include "run_picture.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::session {
class Session;
}

namespace c3de::app {

/// Draws the session's scene as the window would, and writes it as PNG. The slices pass through the middle of the
/// bodies. Parts of masks that are in no body are marked in them, and tissues have their surfaces in space. Main
/// thread.
[[nodiscard]] Expected<void> writeScreenshot(Session &session, render::Renderer &renderer,
                                             const std::filesystem::path &file, int width, int height,
                                             const PictureSources &sources, const Prepared &prepared);

}  // namespace c3de::app
