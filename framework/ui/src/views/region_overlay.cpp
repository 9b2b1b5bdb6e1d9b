// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "views/slice_canvas.h"

namespace c3de::ui {
namespace {

constexpr ImU32 kLine = IM_COL32(255, 152, 56, 255), kBeside = IM_COL32(255, 152, 56, 150),
                kOutside = IM_COL32(0, 0, 0, 95);
constexpr ImU32 kHandle = IM_COL32(24, 26, 30, 200), kHandleLine = IM_COL32(255, 226, 190, 255);

void line(const SliceCanvas &canvas, ImVec2 from, ImVec2 to, bool isCut) {
  const float width = canvas.px(1.6f);
  if (isCut) {
    canvas.list->AddLine(from, to, kTextShadow, canvas.px(3.2f));
    return canvas.list->AddLine(from, to, kLine, width);
  }
  const float length = std::hypot(to.x - from.x, to.y - from.y), dash = canvas.px(6.0f);
  const auto at = [&](float way) {
    const float t = std::min(way / std::max(length, 1.0f), 1.0f);
    return ImVec2(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y));
  };
  for (float way = 0.0f; way < length; way += 2.0f * dash)
    canvas.list->AddLine(at(way), at(way + dash), kBeside, width);
}

void darkenOutside(const SliceCanvas &canvas, ImVec2 min, ImVec2 max) {
  const PixelRect &r = canvas.rect;
  const ImVec2 begin(r.x, r.y), end(r.x + r.w, r.y + r.h);
  const auto clamped = [&](ImVec2 p) {
    return ImVec2(std::clamp(p.x, begin.x, end.x), std::clamp(p.y, begin.y, end.y));
  };
  min = clamped(min);
  max = clamped(max);
  const auto darken = [&](float x0, float y0, float x1, float y1) {
    if (x1 > x0 && y1 > y0) canvas.list->AddRectFilled(ImVec2(x0, y0), ImVec2(x1, y1), kOutside);
  };
  darken(begin.x, begin.y, end.x, min.y);
  darken(begin.x, min.y, min.x, max.y);
  darken(max.x, min.y, end.x, max.y);
  darken(begin.x, max.y, end.x, end.y);
}

void drawHandle(const SliceCanvas &canvas, const BoxHandle &handle, bool isHot, bool isCut) {
  const RegionDrawing &drawing = *canvas.frame.modes.region();
  const ImVec2 at(canvas.rect.x + static_cast<float>(handle.x), canvas.rect.y + static_cast<float>(handle.y));
  const auto size = static_cast<float>(drawing.handle_px());
  const float half = (isHot ? 0.5f : 0.4f) * size;
  const ImVec2 min(at.x - half, at.y - half), max(at.x + half, at.y + half);
  const ImU32 tint = isHot ? kLine : isCut ? kHandleLine : kBeside;
  if (handle.grip.kind == BoxGrip::Kind::whole) {
    for (const auto &[colour, width] : {std::pair{kTextShadow, 4.0f}, {tint, 2.0f}}) {
      canvas.list->AddLine(ImVec2(min.x, at.y), ImVec2(max.x, at.y), colour, canvas.px(width));
      canvas.list->AddLine(ImVec2(at.x, min.y), ImVec2(at.x, max.y), colour, canvas.px(width));
    }
  } else {
    // Letters of the view remain legible over it.
    canvas.list->AddRectFilled(min, max, isHot ? kLine : kHandle, canvas.px(1.5f));
    canvas.list->AddRect(min, max, isHot ? kHandleLine : tint, canvas.px(1.5f), 0, canvas.px(1.5f));
  }
  const PixelRect &r = canvas.rect;
  canvas.frame.automation.widget("region", std::string(paneName(canvas.pane)) + "." + handle.name,
                                 {min.x, min.y, max.x, max.y}, {r.x, r.y, r.x + r.w, r.y + r.h}, true);
}

/// Cursors that the system may lack are drawn by Dear ImGui.
void setCursor(const SliceCanvas &canvas, const BoxGrip &grip) {
  const std::array<int, 2> direction = directionOf(canvas.view, grip);
  ImGuiMouseCursor cursor = ImGuiMouseCursor_Arrow;
  if (grip.kind == BoxGrip::Kind::whole)
    cursor = ImGuiMouseCursor_ResizeAll;
  else if (grip.kind == BoxGrip::Kind::sides)
    cursor = direction[1] == 0              ? ImGuiMouseCursor_ResizeEW
             : direction[0] == 0            ? ImGuiMouseCursor_ResizeNS
             : direction[0] == direction[1] ? ImGuiMouseCursor_ResizeNWSE
                                            : ImGuiMouseCursor_ResizeNESW;
  ImGui::SetMouseCursor(cursor);
  ImGui::GetIO().MouseDrawCursor =
      cursor != ImGuiMouseCursor_Arrow && cursor != ImGuiMouseCursor_ResizeEW && cursor != ImGuiMouseCursor_ResizeNS;
}

const char *nameOf(const BoxGrip &grip) {
  switch (grip.kind) {
    case BoxGrip::Kind::sides: return "side";
    case BoxGrip::Kind::whole: return "move";
    case BoxGrip::Kind::drawn: break;
  }
  return "draw";
}

}  // namespace

void drawRegion(const SliceCanvas &canvas) {
  if (!canvas.frame.modes.region()) return;
  const RegionDrawing &drawing = *canvas.frame.modes.region();
  const BoxInSlice box = boxInSlice(canvas.view, drawing.region().box());
  const auto pixel = [&](double x, double y) {
    return ImVec2(canvas.rect.x + static_cast<float>(x), canvas.rect.y + static_cast<float>(y));
  };
  const ImVec2 min = pixel(box.left, box.top), max = pixel(box.right, box.bottom);
  darkenOutside(canvas, min, box.isCut ? max : min);
  const ImVec2 corners[] = {min, {max.x, min.y}, max, {min.x, max.y}};
  for (std::size_t i = 0; i < 4; ++i) line(canvas, corners[i], corners[(i + 1) % 4], box.isCut);

  const PixelRect &r = canvas.rect;
  FrameContext &frame = canvas.frame;
  const bool isHere = r.contains(frame.mouseX, frame.mouseY) && !ImGui::GetIO().WantCaptureMouse;
  std::optional<BoxGrip> grip = drawing.grip(canvas.pane, frame.mouseX - r.x, frame.mouseY - r.y);
  if (!isHere && !drawing.region().grip()) grip.reset();
  for (const BoxHandle &handle : boxHandles(canvas.view, drawing.region(), drawing.handle_px()))
    drawHandle(canvas, handle, grip && *grip == handle.grip, box.isCut);
  if (grip) setCursor(canvas, *grip);
  const std::string name = paneName(canvas.pane);
  frame.automation.value("region", name + ".grip", grip ? nameOf(*grip) : "none");
  frame.automation.value("region", name + ".is_cut", box.isCut ? "true" : "false");
}

void drawRegionInSpace(FrameContext &frame) {
  if (!frame.modes.region()) return;
  const Box &box = frame.modes.region()->region().box();
  const PixelRect &r = frame.view;
  const auto corner = [&](unsigned c) { return Vec3{box[c & 1u][0], box[c >> 1u & 1u][1], box[c >> 2u & 1u][2]}; };
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  for (unsigned c = 0; c < 8; ++c)
    for (unsigned a = 0; a < 3; ++a) {
      if ((c >> a & 1u) != 0) continue;
      const Vec3 p = frame.camera.project(corner(c), static_cast<int>(r.w), static_cast<int>(r.h)),
                 q = frame.camera.project(corner(c | 1u << a), static_cast<int>(r.w), static_cast<int>(r.h));
      if (!(p[2] > 0.0) || !(q[2] > 0.0)) continue;
      const auto at = [&](const Vec3 &v) {
        return ImVec2(r.x + static_cast<float>(v[0]), r.y + static_cast<float>(v[1]));
      };
      list->AddLine(at(p), at(q), kLine, frame.theme.px(1.5f));
    }
}

}  // namespace c3de::ui
