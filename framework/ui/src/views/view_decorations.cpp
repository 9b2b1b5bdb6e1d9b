// SPDX-License-Identifier: Apache-2.0
#include "views/view_decorations.h"

#include <algorithm>
#include <array>

#include "frame/frame_context.h"

namespace c3de::ui {

void drawViewDecorations(FrameContext &frame) {
  if (frame.view.isEmpty()) return;
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  const PixelRect &view = frame.view;
  list->PushClipRect(ImVec2(view.x, view.y), ImVec2(view.x + view.w, view.y + view.h));

  // World axes as seen by the camera; nearer ends are drawn last.
  struct Axis {
    Vec3 direction;
    const char *name;
    ImU32 tint;
  };
  std::array<Axis, 3> axes{{{{1, 0, 0}, "x", IM_COL32(224, 92, 92, 255)},
                            {{0, 1, 0}, "y", IM_COL32(116, 190, 104, 255)},
                            {{0, 0, 1}, "z", IM_COL32(98, 148, 232, 255)}}};
  const Vec3 right = frame.camera.right(), up = frame.camera.up(), forward = frame.camera.forward();
  std::sort(axes.begin(), axes.end(),
            [&](const Axis &a, const Axis &b) { return dot(a.direction, forward) > dot(b.direction, forward); });
  const float length = frame.theme.px(30.0f);
  const ImVec2 origin(view.x + frame.theme.px(48.0f), view.y + view.h - frame.theme.px(48.0f));
  for (const Axis &axis : axes) {
    const auto dx = static_cast<float>(dot(axis.direction, right)), dy = static_cast<float>(-dot(axis.direction, up));
    const ImVec2 tip(origin.x + dx * length, origin.y + dy * length);
    list->AddLine(origin, tip, axis.tint, frame.theme.px(2.0f));
    const ImVec2 size = ImGui::CalcTextSize(axis.name);
    list->AddText(
        ImVec2(origin.x + dx * 1.35f * length - 0.5f * size.x, origin.y + dy * 1.35f * length - 0.5f * size.y),
        axis.tint, axis.name);
  }

  if (frame.simulation.exists && !frame.simulation.title.empty())
    list->AddText(frame.theme.bold, frame.theme.bold->FontSize,
                  ImVec2(view.x + frame.theme.px(14.0f), view.y + frame.theme.px(10.0f)),
                  ImGui::GetColorU32(colour::kText), frame.simulation.title.c_str());
  list->PopClipRect();
}

}  // namespace c3de::ui
