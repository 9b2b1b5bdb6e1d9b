// SPDX-License-Identifier: Apache-2.0
// Layout of the views of an image, and its slices in them: shared by the window and by pictures without one.
#pragma once

#include "frame/frame_context.h"

namespace c3de::render {
class Renderer;
struct SlicePlane;
struct Viewport;
}  // namespace c3de::render

namespace c3de::ui {

/// Without an image the 3D view fills the area. With an image each view fills a quarter, or a single view fills all of
/// it. Returned by Pane; the slices of the image get their sizes.
/// @param images  null if there is no image
[[nodiscard]] std::array<PixelRect, 4> layOutViews(const PixelRect &area, ImageViews *images);

/// Sets what the renderer shows of the image in space, and the colours of its labels in all views.
/// @param images  null if there is no image
void showInSpace(render::Renderer &renderer, const ImageViews *images);
/// @param port  pixels of the framebuffer
[[nodiscard]] render::SlicePlane planeOf(const ImageViews &images, Pane pane, const render::Viewport &port);
/// For a renderer that has images.
void drawSlice(render::Renderer &renderer, const ImageViews &images, Pane pane, const render::Viewport &port);

}  // namespace c3de::ui
