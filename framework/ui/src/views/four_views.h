// SPDX-License-Identifier: Apache-2.0
// Where the views of an image lie, and its slices in them: the same for the window and for pictures without one.
#pragma once

#include "window/frame_context.h"

namespace c3de::render {
class Renderer;
struct SlicePlane;
struct Viewport;
}  // namespace c3de::render

namespace c3de::ui {

/// Without an image the 3D view fills the area; with one, a quarter, or a single view of it all. By Pane; the slices of
/// the image take the sizes over.
/// @param images  null: there is no image
[[nodiscard]] std::array<PixelRect, 4> layOutViews(const PixelRect &area, ImageViews *images);

/// Tells the renderer what it is to show of the image in space, and the colours of its labels everywhere.
/// @param images  null: there is no image
void showInSpace(render::Renderer &renderer, const ImageViews *images);
/// @param port  pixels of the framebuffer
[[nodiscard]] render::SlicePlane planeOf(const ImageViews &images, Pane pane, const render::Viewport &port);
/// Of a renderer that has images.
void drawSlice(render::Renderer &renderer, const ImageViews &images, Pane pane, const render::Viewport &port);

}  // namespace c3de::ui
