// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/segmentation/scan_body.h"
#include "c3de/ui/image_views.h"
#include "logic/region_box.h"

namespace c3de::ui {

/// While a person draws the region of a scan's body in the slices: their plain left drags are its own, a click without
/// a drag is the cross-hair's. The box is along the axes of the patient and of the scan as it was read; the slices show
/// both so until it ends. The dialog of the scan is aside. No drawing. Main thread; both parameters must outlive it.
class RegionDrawing {
 public:
  /// Begins with the region of the scan, or with all of it. Where only the 3D view is shown, slices come beside it.
  /// @param handle_px  size of a handle
  RegionDrawing(ImageViews &images, segmentation::ScanBody &scan, double handle_px);

  [[nodiscard]] const RegionBox &region() const { return region_; }
  [[nodiscard]] double handle_px() const { return handle_px_; }
  /// The slices of the image are oblique, and have been turned for this.
  [[nodiscard]] bool isTurned() const { return isTurned_; }
  /// What a drag does that begins at a pixel of a slice, or the one that is in progress there. None: nothing.
  [[nodiscard]] std::optional<BoxGrip> grip(Pane slice, double x, double y) const;

  /// Each frame: the slices stay along the axes of the patient. False: end() is all that is left. Either the scan is not
  /// asked about any more, or another one is; or a person has gone back to its dialog, and the region is kept.
  [[nodiscard]] bool follow();
  /// Input in a slice. True: it was taken.
  bool handle(Pane slice, const ViewInput &input);
  /// True: there was a drag, and it is taken back.
  bool cancelDrag();
  /// A drag in progress, or the last step.
  void undo();
  void redo();
  /// All of the scan, as a step.
  void takeAll();
  /// The scan gets the region.
  void keep() { scan_.setRegion(region_.box()); }
  /// The slices are again as they were. Once, as the last call.
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
