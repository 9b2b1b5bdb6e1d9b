// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/ui/image_views.h"

namespace c3de::ui {

/// Mouse and keys in the slices. Left button, mouse moves and wheel go to the active tool if it works in slices, and to
/// ImageViews::handle if the tool does not use them. Slice keys, Shift and Ctrl, the other buttons and a click that
/// picks always go to the slices. Main thread.
class SliceController {
 public:
  explicit SliceController(registry::ToolRegistry &tools) : tools_(tools) {}

  /// Positions relative to the upper left corner of the slice. True if something changed, or the tool used the event.
  bool handle(ImageViews &images, Pane slice, const ViewInput &input);
  /// The tool has been cancelled: a button that is still down is ignored until it is released.
  void cancel() { dragTool_.reset(); }

 private:
  [[nodiscard]] bool sendToTool(const ImageViews &images, Pane slice, const ViewInput &input, std::uint32_t type);
  [[nodiscard]] bool isToolsOwn(const ImageViews &images, Pane slice, const ViewInput &input);

  registry::ToolRegistry &tools_;
  std::optional<Handle> dragTool_;  ///< the tool that received the press
  std::uint32_t buttons_ = 0;
};

}  // namespace c3de::ui
