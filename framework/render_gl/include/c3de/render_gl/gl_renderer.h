// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "c3de/render/renderer.h"

namespace c3de::render {

/// Needs a current OpenGL 4.3 core context (the window requests 4.5); the error states the version found.
[[nodiscard]] Expected<std::unique_ptr<Renderer>> createGlRenderer();

/// An OpenGL context without a window, current on the thread that created it (EGL surfaceless; a hidden window on
/// Windows). The context of a window must not be current on that thread at the same time.
class OffscreenContext {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<OffscreenContext>> create();
  virtual ~OffscreenContext() = default;
};

/// Error if the current context is below 4.3: "OpenGL 4.3 is needed, found …".
[[nodiscard]] Expected<void> checkGlVersion();

}  // namespace c3de::render
