// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/scene/image_store.h"
#include "coverage.h"
#include "export_image.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::app {

class Session;

/// What `--view` chooses.
enum class PictureView { space, axial, sagittal, coronal, four };
[[nodiscard]] const char *nameOf(PictureView view);  ///< as on the command line: "3d", "axial", …, "four-up"
[[nodiscard]] std::optional<PictureView> pictureViewOf(const std::string &name);

/// What is drawn beside the bodies.
struct PictureSources {
  PictureView view = PictureView::space;
  std::shared_ptr<scene::StoredImage> image;    ///< null: none; then only the 3D view can be drawn
  std::shared_ptr<scene::StoredLabels> labels;  ///< null: none
  ImageWarp how;
  bool warp = true;                             ///< the image as the bodies have deformed it, with |u| in colours
};

/// Draws what the session's scene shows, as the window would, and writes it as PNG. The slices go through the middle of the
/// bodies; what of masks is in no body is marked in them. Main thread.
[[nodiscard]] Expected<void> writeScreenshot(Session &session, render::Renderer &renderer, const std::filesystem::path &file,
                                             int width, int height, const PictureSources &sources,
                                             const std::vector<Coverage> &coverage);

}  // namespace c3de::app
