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

/// The views of the workstation as a picture, drawn without a window by what draws them in one: slices with outlines,
/// letters, scale bars and legends beside the 3D view, or the one that ImageViews::maximised() names; without an image
/// the 3D view alone. The 3D view has all of the scene in it.
///
/// @param renderer  its context must be current; no window may be open
/// @param title     in the 3D view
/// Errors: a size that cannot be drawn, no graphics memory, no fonts' texture. Main thread.
[[nodiscard]] Expected<render::Image> pictureOfViews(render::Renderer &renderer, ImageViews &images,
                                                     scene::SceneGraph &scene, const std::string &title, int width,
                                                     int height);

}  // namespace c3de::ui
