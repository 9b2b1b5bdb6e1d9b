// SPDX-License-Identifier: Apache-2.0
#include "views/four_views.h"

#include <cmath>

#include "c3de/render/image_renderer.h"

namespace c3de::ui {

std::array<PixelRect, 4> layOutViews(const PixelRect &area, ImageViews *images) {
  std::array<PixelRect, 4> panes{};
  const auto put = [&](Pane pane, const PixelRect &rect) { panes[static_cast<std::size_t>(pane)] = rect; };
  if (!images) {
    put(Pane::space, area);
    return panes;
  }
  if (images->maximised()) {
    put(*images->maximised(), area);
  } else {
    const float gap = 2.0f, w = std::floor(0.5f * (area.w - gap)), h = std::floor(0.5f * (area.h - gap));
    const float x = area.x + w + gap, y = area.y + h + gap, w2 = area.w - w - gap, h2 = area.h - h - gap;
    put(Pane::axial, {area.x, area.y, w, h});
    put(Pane::sagittal, {x, area.y, w2, h});
    put(Pane::coronal, {area.x, y, w, h2});
    put(Pane::space, {x, y, w2, h2});
  }
  for (const Pane pane : kSlicePanes)
    if (const PixelRect &rect = panes[static_cast<std::size_t>(pane)]; !rect.isEmpty())
      images->view(pane).setSize(static_cast<int>(rect.w), static_cast<int>(rect.h));
  return panes;
}

void showInSpace(render::Renderer &renderer, const ImageViews *images) {
  render::ImageRenderer *drawer = renderer.images();
  if (!drawer) return;
  drawer->setScene(images ? images->scene() : render::ImageScene());
  if (images) drawer->setLabelColours(images->handles().labels, images->labelColours());
}

render::SlicePlane planeOf(const ImageViews &images, Pane pane, const render::Viewport &port) {
  const SliceView &slice = images.view(pane);
  render::SlicePlane plane = slice.plane();
  plane.right = (static_cast<double>(slice.width()) / port.width) * plane.right;
  plane.down = (static_cast<double>(slice.height()) / port.height) * plane.down;
  return plane;
}

void drawSlice(render::Renderer &renderer, const ImageViews &images, Pane pane, const render::Viewport &port) {
  renderer.images()->drawSlice(images.look(), planeOf(images, pane, port), port);
}

}  // namespace c3de::ui
