// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "c3de/ui/mask_brush.h"
#include "views/slice_canvas.h"

namespace c3de::ui {
namespace {

constexpr ImU32 kErasing = IM_COL32(255, 92, 92, 255);
constexpr int kStrokeOpacity = 90;

ImU32 withOpacity(ImU32 tint, int opacity) {
  return (tint & ~IM_COL32_A_MASK) | static_cast<ImU32>(opacity) << IM_COL32_A_SHIFT;
}

}  // namespace

void drawBrush(const SliceCanvas &canvas) {
  if (!canvas.frame.services.brush) return;
  const auto marker = canvas.frame.services.brush->marker();
  if (!marker || marker->pane != canvas.pane) return;
  const auto radius = static_cast<float>(marker->radius_mm / canvas.view.millimetresPerPixel());
  const ImU32 tint =
      marker->isErasing
          ? kErasing
          : ImGui::ColorConvertFloat4ToU32(ImVec4(marker->colour[0], marker->colour[1], marker->colour[2], 1.0f));
  std::vector<ImVec2> path;
  for (const Vec3 &world : marker->path) path.push_back(canvas.pixelOf(world));
  if (!path.empty()) {
    const ImU32 faint = withOpacity(tint, kStrokeOpacity);
    canvas.list->AddCircleFilled(path.front(), radius, faint);
    if (path.size() > 1) {
      canvas.list->AddPolyline(path.data(), static_cast<int>(path.size()), faint, ImDrawFlags_None, 2.0f * radius);
      canvas.list->AddCircleFilled(path.back(), radius, faint);
    }
  }
  const PixelRect &r = canvas.rect;
  const bool isHere = r.contains(canvas.frame.mouseX, canvas.frame.mouseY);
  if (isHere || !path.empty()) {
    const ImVec2 at = isHere ? ImVec2(static_cast<float>(canvas.frame.mouseX), static_cast<float>(canvas.frame.mouseY))
                             : canvas.pixelOf(marker->centre);
    canvas.list->AddCircle(at, std::max(radius, canvas.px(1.5f)), kTextShadow, 0, canvas.px(3.0f));
    canvas.list->AddCircle(at, std::max(radius, canvas.px(1.5f)), tint, 0, canvas.px(1.5f));
  }
  canvas.frame.automation.value("image", "brush",
                                fmt::format("{} {:.2f} mm", marker->isErasing ? "erase" : "paint", marker->radius_mm));
}

}  // namespace c3de::ui
