// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::scene {
class SceneGraph;
}

namespace c3de::ui {

class ImageViews;

/// The views of the workstation as a picture, drawn without a window by the code that draws them in a window. Slices
/// with outlines, letters, scale bars and legends next to the 3D view, or the single view of ImageViews::maximised().
/// Without an image only the 3D view. The 3D view shows the whole scene.
///
/// @param renderer  its context must be current; no window may be open
/// @param title     in the 3D view
/// Errors: a size that cannot be drawn, no graphics memory, no font texture. Main thread.
[[nodiscard]] Expected<render::Image> pictureOfViews(render::Renderer &renderer, ImageViews &images,
                                                     scene::SceneGraph &scene, const std::string &title, int width,
                                                     int height);

}  // namespace c3de::ui
