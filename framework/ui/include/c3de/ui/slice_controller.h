// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/ui/image_views.h"

namespace c3de::ui {

/// Mouse and keys in the slices: left button, mouse and wheel belong to the active tool if that works in slices, and
/// what it does not want to ImageViews::handle. Slice keys, Shift and Ctrl, the other buttons and a click that picks
/// stay with the slices. Main thread.
class SliceController {
 public:
  explicit SliceController(registry::ToolRegistry &tools) : tools_(tools) {}

  /// Positions from the upper left corner of the slice. True: something changed, or the tool took it.
  bool handle(ImageViews &images, Pane slice, const ViewInput &input);
  /// The tool has been cancelled: a button that is still down is ignored until it is released.
  void cancel() { dragTool_.reset(); }

 private:
  [[nodiscard]] bool tellTool(const ImageViews &images, Pane slice, const ViewInput &input, std::uint32_t type);
  [[nodiscard]] bool isToolsOwn(const ImageViews &images, Pane slice, const ViewInput &input);

  registry::ToolRegistry &tools_;
  std::optional<Handle> dragTool_;  ///< that has taken a press
  std::uint32_t buttons_ = 0;
};

}  // namespace c3de::ui
