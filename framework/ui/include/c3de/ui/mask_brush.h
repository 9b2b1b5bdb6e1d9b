// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "c3de/abi/tools.h"
#include "c3de/core/handle.h"
#include "c3de/core/vec.h"
#include "c3de/ui/image_views.h"

namespace c3de::registry {
class ToolRegistry;
}
namespace c3de::segmentation {
class SegmentationWorkflow;
}

namespace c3de::ui {

/// The tool that paints the mask in slices: a left drag is one step of the segmentation, applied when the button is
/// released. Keys: [ and ] change the radius, E switches between painting and erasing. No drawing. Main thread; the
/// arguments must outlive this.
class MaskBrush {
 public:
  MaskBrush(registry::ToolRegistry &tools, ImageViews &images, segmentation::SegmentationWorkflow &workflow);
  ~MaskBrush();
  MaskBrush(const MaskBrush &) = delete;
  MaskBrush &operator=(const MaskBrush &) = delete;

  /// Registers the tool, or removes it.
  void offer(bool isOffered);
  [[nodiscard]] bool isActive() const;
  /// Activates the tool, or deactivates it if it is active.
  void toggle();

  /// What the slices show of the brush.
  struct Marker {
    Pane pane;               ///< the slice under the mouse
    Vec3 centre{};           ///< world, as displayed
    std::vector<Vec3> path;  ///< world, as displayed; of the drag in progress
    double radius_mm = 0.0;
    bool isErasing = false;
    render::Colour colour{};  ///< of the mask
  };
  /// None while the tool is not active, or the mouse has not been over a slice.
  [[nodiscard]] std::optional<Marker> marker() const;

  static constexpr double kSmallest_mm = 0.5, kLargest_mm = 50.0;

 private:
  static c3de_status C3DE_CALL onActivate(void *self);
  static void C3DE_CALL onCancel(void *self);
  static c3de_status C3DE_CALL onEvent(void *self, const c3de_event *event, std::uint32_t *consumed);
  bool handle(const c3de_event &event);
  void press(const Vec3 &world);
  void extend(const Vec3 &world);
  /// Applies the drag so far.
  void finish();
  bool pressKey(std::uint32_t key);

  registry::ToolRegistry &tools_;
  ImageViews &images_;
  segmentation::SegmentationWorkflow &workflow_;
  Handle tool_;
  std::optional<Pane> pane_;
  Vec3 centre_{}, normal_{};
  bool isDown_ = false;
  std::vector<Vec3> path_;       ///< as displayed
  std::vector<Vec3> reference_;  ///< the same points in the image as it was read
};

}  // namespace c3de::ui
