// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/render/camera.h"
#include "c3de/render/renderer.h"
#include "c3de/ui/figure.h"
#include "c3de/ui/plots.h"

namespace c3de::scene {
class SceneGraph;
}

namespace c3de::ui {

class ImageViews;
struct WindowServices;

/// Where the 3D view of a picture is seen from; what is not given is that of the window at its beginning.
struct SpaceDirection {
  std::optional<double> yaw, pitch;  ///< as render::Camera, rad
  std::optional<render::UpAxis> upAxis;
};

/// The views of the workstation as a picture, drawn without a window by the code that draws them in a window. Slices
/// with outlines, letters, scale bars and legends next to the 3D view, or the single view of ImageViews::maximised().
/// Without an image only the 3D view. The 3D view shows the whole scene.
///
/// @param renderer  its context must be current; no frame of a window may be in progress
/// @param title     in the 3D view
/// Errors: a size that cannot be drawn, no graphics memory, no font texture. Main thread.
[[nodiscard]] Expected<render::Image> pictureOfViews(render::Renderer &renderer, ImageViews &images,
                                                     scene::SceneGraph &scene, const std::string &title, int width,
                                                     int height, const SpaceDirection &direction = {});

/// Draws a figure of what a window shows, one view after the other, so that the window can respond in between. Views,
/// camera and texts are those of the moment of create(). What the renderer and the services have must not change until
/// the last view is drawn. Main thread; the renderer's context must be current, also when it is destroyed, and no frame
/// of the window may be in progress.
class FigurePainter {
 public:
  struct Request {
    FigureSettings settings;
    double shownAspect = 1.0;  ///< width / height of the views in the window
    render::Camera camera;
    std::string title, caption;
  };
  /// @param services  scene, images and measurements are used
  /// Errors: a size that is not accepted, no font texture.
  [[nodiscard]] static Expected<std::unique_ptr<FigurePainter>> create(render::Renderer &renderer,
                                                                       const WindowServices &services,
                                                                       const Request &request);
  ~FigurePainter();

  [[nodiscard]] std::size_t viewCount() const;
  [[nodiscard]] std::size_t drawnCount() const;
  /// Errors: more pixels than the graphics device can draw, or has memory for.
  [[nodiscard]] Expected<void> drawNext();
  /// The figure, when all views have been drawn.
  [[nodiscard]] render::Image take();

 private:
  struct Impl;
  explicit FigurePainter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The shown curves as a figure: its width, resolution, size of text and background; twice as wide as high, unless the
/// settings have another shape than that of the window.
/// @param now_s  time that a line marks
/// Errors: as for figures. Main thread; no frame of a window may be in progress.
[[nodiscard]] Expected<render::Image> pictureOfPlots(const PlotList &plots, const FigureSettings &settings,
                                                     std::optional<double> now_s);

/// The longest side of a figure that the graphics device can draw, pixels: half a figure for each of four views.
/// @param hasFourViews  the figure is divided into four views
[[nodiscard]] int largestFigureSide(bool hasFourViews);

}  // namespace c3de::ui
