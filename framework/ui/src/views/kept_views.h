// SPDX-License-Identifier: Apache-2.0
// The views as the window shows them: one in which nothing has changed is not drawn again. Most frames answer the
// mouse, keys or panels, or show a body that has moved while the slices have not; without a graphics processor the
// views take most of the time of a frame.
#pragma once

#include <functional>
#include <optional>

#include "c3de/render/image_renderer.h"
#include "c3de/render_gl/kept_picture.h"
#include "window/frame_context.h"

namespace c3de::ui {

class KeptViews {
 public:
  struct Layout {
    PixelRect area;                                                 ///< of all views
    std::array<PixelRect, 4> panes;                                 ///< by Pane
    std::function<render::Viewport(const PixelRect &)> viewportOf;  ///< pixels of the framebuffer
    std::array<int, 2> framebuffer{};
  };
  /// Brings slices and 3D view into the bound framebuffer as they are now.
  /// @param images  null: there is no image
  void draw(render::Renderer &renderer, const ImageViews *images, const render::Camera &camera, const Layout &layout);

 private:
  /// What a picture of a slice follows from.
  struct Slice {
    render::ImageLook look;
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

  render::KeptPicture picture_;
  std::array<render::Viewport, 4> ports_{};  ///< of what is kept
  std::array<std::optional<Slice>, 3> slices_;
  std::optional<Space> space_;
};

}  // namespace c3de::ui
