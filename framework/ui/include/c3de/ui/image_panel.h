// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/ui/image_views.h"
#include "c3de/ui/panel_registry.h"

namespace c3de::ui {

/// The panel of the open image: window and level, labels, slices and volume in space, displacement. It stands in the
/// registry while it lives. Main thread.
class ImagePanel {
 public:
  ImagePanel(PanelRegistry &panels, ImageViews &views);
  ~ImagePanel();
  ImagePanel(const ImagePanel &) = delete;
  ImagePanel &operator=(const ImagePanel &) = delete;

 private:
  void draw(const c3de_ui_v0 &ui);
  void drawWindowLevel(const c3de_ui_v0 &ui, ImageOptions &options);
  void drawViews(const c3de_ui_v0 &ui, ImageOptions &options);
  void drawLabels(const c3de_ui_v0 &ui, ImageOptions &options);
  void drawVolume(const c3de_ui_v0 &ui, ImageOptions &options);
  void drawShift(const c3de_ui_v0 &ui, ImageOptions &options);

  PanelRegistry &panels_;
  ImageViews &views_;
  Handle panel_;
};

}  // namespace c3de::ui
