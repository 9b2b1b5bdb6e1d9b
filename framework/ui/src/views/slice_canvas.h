// SPDX-License-Identifier: Apache-2.0
// Where something is drawn over a slice.
#pragma once

#include <imgui.h>

#include "window/frame_context.h"

namespace c3de::ui {

/// Below lines and letters, so that they are seen over bright tissue.
inline constexpr ImU32 kShadow = IM_COL32(0, 0, 0, 200);

/// One slice of the frame, with what is needed to draw over it.
struct SliceCanvas {
  FrameContext &frame;
  const ImageViews &images;
  Pane pane;
  const PixelRect &rect;
  const SliceView &view;
  ImDrawList *list;

  [[nodiscard]] ImVec2 pixelOf(const Vec3 &world) const {
    const SliceView::Pixel p = view.pixelOf(world);
    return {rect.x + static_cast<float>(p.x), rect.y + static_cast<float>(p.y)};
  }
  [[nodiscard]] float px(float logical) const { return frame.theme.px(logical); }
  /// Of the read-out below: while images deform there is one more, for the tissue.
  [[nodiscard]] float readoutHeight() const {
    return (images.showsDisplacement() ? 2.0f : 1.0f) * (ImGui::GetTextLineHeight() + px(2.0f));
  }
};

/// The region of a scan's body while it is drawn: its outline and handles, what lies outside of it darker. The mouse
/// shows what it would do.
void drawRegion(const SliceCanvas &canvas);
/// Its edges in the 3D view, in front of everything.
void drawRegionInSpace(FrameContext &frame);

}  // namespace c3de::ui
