// SPDX-License-Identifier: Apache-2.0
#include "views/view_cache.h"

#include <epoxy/gl.h>

#include "frame/theme.h"
#include "views/four_views.h"

namespace c3de::ui {

void ViewCache::forget() {
  slices_ = {};
  space_.reset();
}

void ViewCache::draw(render::Renderer &renderer, const ImageViews *images, const render::Camera &camera,
                     const Layout &layout) {
  showInSpace(renderer, images);
  std::array<render::Viewport, 4> ports{};
  for (std::size_t pane = 0; pane < ports.size(); ++pane)
    if (!layout.panes[pane].isEmpty()) ports[pane] = layout.viewportOf(layout.panes[pane]);
  const auto state = picture_.prepare(layout.framebuffer[0], layout.framebuffer[1]);
  // If views have moved, one may have been drawn over another.
  const bool isNew = state != render::CachedPicture::State::kept || ports != ports_;
  if (isNew) forget();
  ports_ = ports;
  area_ = layout.viewportOf(layout.area);
  isCached_ = state != render::CachedPicture::State::none;
  if (!isCached_) {
    drawWhatChanged(renderer, images, camera);
    return copy_.take(area_);
  }
  picture_.paint([&] {
    if (isNew) {
      glDisable(GL_SCISSOR_TEST);
      const ImVec4 &between = paletteOf(ThemeKind::dark).chrome;
      glClearColor(between.x, between.y, between.z, 1.0f);
      glClear(GL_COLOR_BUFFER_BIT);
    }
    drawWhatChanged(renderer, images, camera);
  });
  picture_.show(area_);
}

std::optional<render::Image> ViewCache::picture() const { return isCached_ ? picture_.read(area_) : copy_.read(); }

void ViewCache::drawWhatChanged(render::Renderer &renderer, const ImageViews *images, const render::Camera &camera) {
  const render::ImageRenderer *drawer = renderer.images();
  for (const Pane pane : kSlicePanes) {
    const auto p = static_cast<std::size_t>(pane);
    if (!images || !drawer || ports_[p].width == 0) continue;
    const Slice slice{images->look(), planeOf(*images, pane, ports_[p]), drawer->changes()};
    if (slices_[p] == slice) continue;
    drawSlice(renderer, *images, pane, ports_[p]);
    slices_[p] = slice;
  }
  const render::Viewport &port = ports_[static_cast<std::size_t>(Pane::space)];
  const Space space{camera, renderer.changes()};
  if (port.width == 0 || (space_ == space && !(drawer && drawer->wantsRefinement()))) return;
  renderer.draw(camera, port);
  space_ = space;
}

}  // namespace c3de::ui
