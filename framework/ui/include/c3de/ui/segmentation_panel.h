// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "c3de/registry/panel_registry.h"
#include "c3de/segmentation/scan_body.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/mask_brush.h"

namespace c3de::ui {

/// The panel that leads from an image to a body of the simulation, in numbered steps. It is registered for as long as
/// this object exists. Main thread.
class SegmentationPanel {
 public:
  struct Parts {
    ImageViews &views;
    segmentation::SegmentationWorkflow &workflow;
    segmentation::ScanBody &scanBody;  ///< shown by a button
    MaskBrush &brush;                  ///< activated by a button
    std::function<void()> saveLabels;  ///< asks for a file
  };
  SegmentationPanel(registry::PanelRegistry &panels, Parts parts);
  ~SegmentationPanel();
  SegmentationPanel(const SegmentationPanel &) = delete;
  SegmentationPanel &operator=(const SegmentationPanel &) = delete;

 private:
  void draw(const c3de_ui_v1 &ui);
  /// A button that waits for a click in a slice, and stops waiting when it is pressed again.
  void clickButton(const c3de_ui_v1 &ui, const char *id, const char *label, const char *doc,
                   void (segmentation::SegmentationWorkflow::*clicked)(const Vec3 &));
  void drawSource(const c3de_ui_v1 &ui);
  void drawBodies(const c3de_ui_v1 &ui);
  void drawUpdate(const c3de_ui_v1 &ui);
  void drawLabels(const c3de_ui_v1 &ui);
  void drawThreshold(const c3de_ui_v1 &ui);
  void drawHistogram(const c3de_ui_v1 &ui, const scene::StoredImage &image);
  void drawMask(const c3de_ui_v1 &ui);
  void drawPainting(const c3de_ui_v1 &ui);
  void drawGrowing(const c3de_ui_v1 &ui);
  void drawSteps(const c3de_ui_v1 &ui);
  void drawUndo(const c3de_ui_v1 &ui);
  void drawSeveral(const c3de_ui_v1 &ui);
  void drawMaterial(const c3de_ui_v1 &ui);
  void drawMaterials(const c3de_ui_v1 &ui);
  void drawSampling(const c3de_ui_v1 &ui);
  void drawHolding(const c3de_ui_v1 &ui);

  registry::PanelRegistry &panels_;
  ImageViews &views_;
  segmentation::SegmentationWorkflow &workflow_;
  segmentation::ScanBody &scanBody_;
  MaskBrush &brush_;
  std::function<void()> saveLabels_;
  Handle panel_;
  std::string filter_;             ///< of the listed labels
  const char *awaited_ = nullptr;  ///< id of the last pressed button
};

}  // namespace c3de::ui
