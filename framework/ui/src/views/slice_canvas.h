// SPDX-License-Identifier: Apache-2.0
// Canvas for drawing over a slice.
#pragma once

#include <imgui.h>

#include "frame/frame_context.h"

namespace c3de::ui {

/// Drawn below lines and letters, so that they are visible over bright tissue.
inline constexpr ImU32 kTextShadow = IM_COL32(0, 0, 0, 200);

/// One slice of the frame, with the data needed to draw over it.
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
  /// Height of the read-out at the bottom: while images deform it has an additional line for the tissue.
  [[nodiscard]] float readoutHeight() const {
    if (!frame.hasAnnotations()) return 0.0f;
    return (images.showsDisplacement() ? 2.0f : 1.0f) * (ImGui::GetTextLineHeight() + px(2.0f));
  }
};

/// The region of a scan's body while it is being drawn: its outline and handles, with everything outside darkened. The
/// mouse cursor indicates the effect of a drag.
void drawRegion(const SliceCanvas &canvas);
/// The brush that paints the mask: its outline under the mouse, and the drag in progress.
void drawBrush(const SliceCanvas &canvas);
/// Landmarks, distances and angles; those off the plane are small and faint.
void drawMeasurementsInSlice(const SliceCanvas &canvas);
/// The edges of the region in the 3D view, in front of everything.
void drawRegionInSpace(FrameContext &frame);

}  // namespace c3de::ui
