// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "app.h"
#include "c3de/session/tissue_tracker.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/tissue_table.h"

namespace c3de::app {

/// The table of the tissues of bodies and the tracker that computes its motions. Main thread, except the tracker. Must
/// outlive the session, whose simulation calls the tracker.
class TissueTableController {
 public:
  /// @param views    of the image, whose labels give the colours
  /// @param renewed  called on another thread when there are new values
  TissueTableController(const ui::ImageViews &views, std::function<void()> renewed)
      : views_(views), tracker_(std::move(renewed)) {}

  [[nodiscard]] TissueTracker &tracker() { return tracker_; }
  [[nodiscard]] ui::TissueTable &table() { return table_; }
  /// Called before a frame: motion of the labels, while the table is visible.
  void update();

 private:
  [[nodiscard]] ui::TissueRow rowOf(const TissueVoxels &body, const LabelVoxels &label,
                                    const LabelMotion *motion) const;

  const ui::ImageViews &views_;
  TissueTracker tracker_;
  ui::TissueTable table_;
  std::shared_ptr<const std::vector<TissueVoxels>> shownBodies_;
  std::shared_ptr<const std::vector<TissueMotion>> shownMotions_;
};

}  // namespace c3de::app
