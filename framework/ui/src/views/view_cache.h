// SPDX-License-Identifier: Apache-2.0
// Cache of the window's views: a view in which nothing has changed is not drawn again. Most frames respond to mouse,
// keys or panels, or show a body that has moved while the slices have not. Without a graphics processor the views take
// most of the time of a frame.
#pragma once

#include <functional>
#include <optional>

#include "c3de/render/image_renderer.h"
#include "c3de/render_gl/kept_picture.h"
#include "frame/frame_context.h"

namespace c3de::ui {

class ViewCache {
 public:
  struct Layout {
    PixelRect area;                                                 ///< of all views
    std::array<PixelRect, 4> panes;                                 ///< by Pane
    std::function<render::Viewport(const PixelRect &)> viewportOf;  ///< pixels of the framebuffer
    std::array<int, 2> framebuffer{};
  };
  /// Draws slices and 3D view into the bound framebuffer in their present state.
  /// @param images  null if there is no image
  void draw(render::Renderer &renderer, const ImageViews *images, const render::Camera &camera, const Layout &layout);
  /// All views as they were last drawn, without texts. Empty: nothing has been drawn, or not enough graphics memory.
  [[nodiscard]] std::optional<render::Image> picture() const;

 private:
  /// Everything that determines the picture of a slice.
  struct Slice {
    render::ImageDisplay look;
    render::SlicePlane plane;
    std::uint64_t changes = 0;
    friend bool operator==(const Slice &, const Slice &) = default;
  };
  struct Space {
    render::Camera camera;
    std::uint64_t changes = 0;
    friend bool operator==(const Space &, const Space &) = default;
  };
  void drawWhatChanged(render::Renderer &renderer, const ImageViews *images, const render::Camera &camera);
  void forget();

  render::CachedPicture picture_;
  bool isCached_ = false;                    ///< the views were last drawn into the cached picture
  render::FramebufferCopy copy_;             ///< of the views, while they are not cached
  render::Viewport area_;                    ///< of the views when they were last drawn
  std::array<render::Viewport, 4> ports_{};  ///< of the stored picture
  std::array<std::optional<Slice>, 3> slices_;
  std::optional<Space> space_;
};

}  // namespace c3de::ui
