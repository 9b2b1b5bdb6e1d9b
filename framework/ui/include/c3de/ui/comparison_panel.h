// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>

#include "c3de/registry/panel_registry.h"
#include "c3de/ui/comparison.h"
#include "c3de/ui/image_views.h"

namespace c3de::ui {

/// The panel of the second scan: how it is shown, and where. It is registered for as long as this object exists. Main
/// thread; what is passed must outlive this.
class ComparisonPanel {
 public:
  struct Actions {
    std::function<void(const std::filesystem::path &landmarks)> align;
    std::function<void()> remove;  ///< may destroy the panel
  };
  ComparisonPanel(registry::PanelRegistry &panels, Comparison &comparison, const ImageViews &views, Actions actions);
  ~ComparisonPanel();
  ComparisonPanel(const ComparisonPanel &) = delete;
  ComparisonPanel &operator=(const ComparisonPanel &) = delete;

 private:
  void draw(const c3de_ui_v1 &ui);
  void drawLook(const c3de_ui_v1 &ui);
  void drawPlace(const c3de_ui_v1 &ui);
  void drawNumbers(const c3de_ui_v1 &ui);

  registry::PanelRegistry &panels_;
  Comparison &comparison_;
  const ImageViews &views_;
  Actions actions_;
  std::array<char, 4096> landmarks_{};  ///< path of the last file
  Handle panel_;
};

}  // namespace c3de::ui
