// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::app {

class Session;

/// Draws what the session's scene shows, all of it in view, and writes it as PNG. Main thread.
[[nodiscard]] Expected<void> writeScreenshot(Session &session, render::Renderer &renderer,
                                             const std::filesystem::path &file, int width, int height);

}  // namespace c3de::app
