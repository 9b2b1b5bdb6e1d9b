// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/segmentation/scan_body.h"
#include "c3de/ui/image_views.h"
#include "logic/region_box.h"

namespace c3de::ui {

/// Interaction while the user draws the region of a scan's body in the slices. Plain left drags change the region; a
/// click without a drag moves the cross-hair. The box is aligned with the axes of the patient and with the scan as it
/// was read. The slices use the same alignment until drawing ends. The scan dialog is hidden. No drawing. Main thread;
/// both parameters must outlive this.
class RegionDrawing {
 public:
  /// Begins with the region of the scan, or with all of it. If only the 3D view is shown, slices are added next to it.
  /// @param handle_px  size of a handle
  RegionDrawing(ImageViews &images, segmentation::ScanBody &scan, double handle_px);

  [[nodiscard]] const RegionBox &region() const { return region_; }
  [[nodiscard]] double handle_px() const { return handle_px_; }
  /// The slices of the image are oblique, and have been rotated for this.
  [[nodiscard]] bool isTurned() const { return isTurned_; }
  /// What a drag that begins at a pixel of a slice does, or the drag in progress there. None if nothing.
  [[nodiscard]] std::optional<BoxGrip> grip(Pane slice, double x, double y) const;

  /// Called each frame: keeps the slices along the axes of the patient. Returns false when only end() remains to be
  /// called. Either the scan dialog is closed or shows another scan, or the user has returned to it and the region is
  /// kept.
  [[nodiscard]] bool follow();
  /// Input in a slice. True if it was used.
  bool handle(Pane slice, const ViewInput &input);
  /// True if there was a drag; it is taken back.
  bool cancelDrag();
  /// Undoes a drag in progress, or the last step.
  void undo();
  void redo();
  /// Expands to all of the scan, as a step.
  void takeAll();
  /// Assigns the region to the scan.
  void keep() { scan_.setRegion(region_.box()); }
  /// Restores the slices. Called once, as the last call.
  void end();

 private:
  struct Press {
    Pane slice;
    ViewInput input;
    bool isDrag = false;
  };
  void release(const ViewInput &input);

  ImageViews &images_;
  segmentation::ScanBody &scan_;
  RegionBox region_;
  double handle_px_;
  std::optional<Press> press_;
  std::uint32_t buttons_ = 0;
  bool isTurned_ = false, wasAligned_ = false, wasWindowLevel_ = false;
};

}  // namespace c3de::ui
