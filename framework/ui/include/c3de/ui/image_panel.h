// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/registry/panel_registry.h"
#include "c3de/ui/image_views.h"

namespace c3de::ui {

/// The panel of the open image: window and level, labels, slices and volume in space, displacement. It is registered
/// for as long as this object exists. Main thread.
class ImagePanel {
 public:
  /// The open label maps, one of which is shown. Without functions there is no choice.
  struct LabelMaps {
    std::function<std::vector<std::string>()> names;
    std::function<std::size_t()> shown;  ///< index into the names
    std::function<void(std::size_t)> show;
  };
  ImagePanel(registry::PanelRegistry &panels, ImageViews &views, LabelMaps labelMaps = {});
  ~ImagePanel();
  ImagePanel(const ImagePanel &) = delete;
  ImagePanel &operator=(const ImagePanel &) = delete;

 private:
  void draw(const c3de_ui_v1 &ui);
  void drawTime(const c3de_ui_v1 &ui, const scene::StoredImage &image);
  void drawWindowLevel(const c3de_ui_v1 &ui, ImageOptions &options);
  void drawViews(const c3de_ui_v1 &ui, ImageOptions &options);
  void drawLabels(const c3de_ui_v1 &ui, ImageOptions &options);
  void drawVolume(const c3de_ui_v1 &ui, ImageOptions &options);
  void drawFixedRegions(const c3de_ui_v1 &ui, scene::SceneFixedRegions &still);
  void drawShift(const c3de_ui_v1 &ui, ImageOptions &options);
  void drawOverlay(const c3de_ui_v1 &ui, ImageOptions &options);

  registry::PanelRegistry &panels_;
  ImageViews &views_;
  LabelMaps labelMaps_;
  std::string labelFilter_;
  Handle panel_;
};

}  // namespace c3de::ui
