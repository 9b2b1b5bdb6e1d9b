// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/scene/image_store.h"
#include "c3de/session/export_image.h"
#include "c3de/session/picture_view.h"
#include "c3de/session/preparation.h"

namespace c3de::render {
class Renderer;
}
namespace c3de::session {
class Session;
}

namespace c3de::app {

/// What is drawn in addition to the bodies.
struct PictureSources {
  PictureView view = PictureView::space;
  PictureCamera camera;
  std::shared_ptr<scene::StoredImage> image;    ///< null if there is none; then only the 3D view can be drawn
  std::shared_ptr<scene::StoredLabels> labels;  ///< null if there are none
  ImageWarp how;
  bool warp = true;  ///< the image as deformed by the bodies, with the overlay
  PictureOverlay overlay;
};

/// Draws the end of a run without a window. It outlives the session.
class RunPicture {
 public:
  /// ErrorCode::graphics: no OpenGL on this machine, or a program without it.
  [[nodiscard]] static Expected<std::unique_ptr<RunPicture>> create();
  virtual ~RunPicture() = default;
  [[nodiscard]] virtual render::Renderer &renderer() = 0;
  /// Same as writeScreenshot().
  [[nodiscard]] virtual Expected<void> write(Session &session, const std::filesystem::path &file, int width, int height,
                                             const PictureSources &sources, const Prepared &prepared) = 0;
};

}  // namespace c3de::app
