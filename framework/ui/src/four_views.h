// SPDX-License-Identifier: Apache-2.0
// Where the views of an image lie, and its slices in them: the same for the window and for pictures without one.
#pragma once

#include <functional>

#include "frame_context.h"

namespace c3de::render {
class Renderer;
struct Viewport;
}  // namespace c3de::render

namespace c3de::ui {

/// Without an image the 3D view fills the area; with one, a quarter, or a single view of it all. By Pane; the slices of the
/// image take the sizes over.
/// @param images  null: there is no image
[[nodiscard]] std::array<PixelRect, 4> layOutViews(const PixelRect &area, ImageViews *images);

/// Draws the slices, and tells the renderer what it is to show of the image in space.
/// @param images      null: there is no image
/// @param viewportOf  pixels of the framebuffer of a rectangle
void drawSlices(render::Renderer &renderer, const ImageViews *images, const std::array<PixelRect, 4> &panes,
                const std::function<render::Viewport(const PixelRect &)> &viewportOf);

}  // namespace c3de::ui
