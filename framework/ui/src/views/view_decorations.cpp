// SPDX-License-Identifier: Apache-2.0
#include "views/view_decorations.h"

#include <algorithm>
#include <array>

#include "frame/frame_context.h"

namespace c3de::ui {

namespace {

ImU32 inkOf(const FrameContext &frame) {
  return frame.isLight() ? IM_COL32(20, 23, 28, 255) : ImGui::GetColorU32(paletteOf(ThemeKind::dark).text);
}

void drawAxes(const FrameContext &frame, ImDrawList *list) {
  const PixelRect &view = frame.view;
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
}

/// Its length is right at the depth of the point that the camera turns about.
void drawScaleBarInSpace(const FrameContext &frame, ImDrawList *list) {
  const PixelRect &view = frame.view;
  const double perPixel = frame.camera.millimetresPerPixel(frame.camera.focus, static_cast<int>(view.h));
  const ScaleBar bar = scaleBarInMillimetres(perPixel, 0.25 * view.w);
  if (bar.text.empty()) return;
  const float edge = frame.theme.px(14.0f), tick = frame.theme.px(4.0f), width = frame.theme.px(1.5f);
  const float x1 = view.x + view.w - edge, x0 = x1 - static_cast<float>(bar.length_px), y = view.y + view.h - edge;
  const ImU32 ink = inkOf(frame);
  list->AddLine(ImVec2(x0, y), ImVec2(x1, y), ink, width);
  for (const float x : {x0, x1}) list->AddLine(ImVec2(x, y - tick), ImVec2(x, y + tick), ink, width);
  const float half = 0.5f * ImGui::CalcTextSize(bar.text.c_str()).x;
  list->AddText(ImVec2(0.5f * (x0 + x1) - half, y - tick - ImGui::GetTextLineHeight() - 1.0f), ink, bar.text.c_str());
}

}  // namespace

void drawViewDecorations(FrameContext &frame) {
  if (frame.view.isEmpty()) return;
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  const PixelRect &view = frame.view;
  list->PushClipRect(ImVec2(view.x, view.y), ImVec2(view.x + view.w, view.y + view.h));
  if (frame.hasAnnotations()) drawAxes(frame, list);
  ImVec2 at(view.x + frame.theme.px(14.0f), view.y + frame.theme.px(10.0f));
  if (frame.hasAnnotations() && frame.simulation.exists && !frame.simulation.title.empty()) {
    ImGui::PushFont(frame.theme.bold);
    list->AddText(at, inkOf(frame), frame.simulation.title.c_str());
    at.y += 1.4f * ImGui::GetTextLineHeight();
    ImGui::PopFont();
  }
  if (frame.figure) {
    ImGui::PushFont(frame.theme.small);
    if (!frame.figure->caption.empty()) list->AddText(at, inkOf(frame), frame.figure->caption.c_str());
    drawScaleBarInSpace(frame, list);
    ImGui::PopFont();
  }
  list->PopClipRect();
}

}  // namespace c3de::ui
