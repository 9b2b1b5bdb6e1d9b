// SPDX-License-Identifier: Apache-2.0
// Landmarks, distances and angles over slices and the 3D view.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "c3de/ui/measurement_tools.h"
#include "views/slice_canvas.h"
#include "views/view_decorations.h"

namespace c3de::ui {
namespace {

constexpr ImU32 kPoint = IM_COL32(255, 214, 92, 255), kSelected = IM_COL32(255, 140, 60, 255),
                kTarget = IM_COL32(120, 230, 140, 255);

/// One view: where a point of the world is drawn, and how far it is from the plane of a slice.
struct MarkView {
  FrameContext &frame;
  ImDrawList *list;
  std::function<std::optional<ImVec2>(const Vec3 &)> pixelOf;
  std::function<bool(const Vec3 &)> isNear;
  const PixelRect &rect;
  bool isInSlice = false;
  std::vector<PixelRect> labels{};  ///< drawn so far
};

bool overlap(const PixelRect &a, const PixelRect &b) {
  return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

/// Moves a label down, past those that are drawn; after kMostRows rows it stays there.
PixelRect withoutOverlap(const std::vector<PixelRect> &labels, PixelRect label) {
  constexpr int kMostRows = 8;
  const auto hits = [&](const PixelRect &other) { return overlap(label, other); };
  for (int row = 0; row < kMostRows; ++row) {
    const auto hit = std::find_if(labels.begin(), labels.end(), hits);
    if (hit == labels.end()) break;
    label.y = hit->y + hit->h;
  }
  return label;
}

ImU32 faint(ImU32 tint, bool isNear) { return isNear ? tint : (tint & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 90); }

void label(MarkView &view, ImVec2 at, ImU32 tint, const std::string &text) {
  const float away = view.frame.theme.px(7.0f);
  const bool isOnLight = view.frame.isLight() && !view.isInSlice;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const PixelRect box = withoutOverlap(view.labels, {at.x + away, at.y - away, size.x, size.y});
  view.labels.push_back(box);
  if (!isOnLight) view.list->AddText(ImVec2(box.x + 1, box.y + 1), kTextShadow, text.c_str());
  view.list->AddText(ImVec2(box.x, box.y), isOnLight ? IM_COL32(20, 23, 28, 255) : tint, text.c_str());
}

void drawPoint(MarkView &view, const Vec3 &world, ImU32 tint, const std::string &text) {
  const auto at = view.pixelOf(world);
  if (!at) return;
  const bool isNear = view.isNear(world);
  const float radius = view.frame.theme.px(isNear ? 4.0f : 2.5f);
  view.list->AddCircleFilled(*at, radius + 1.0f, faint(kTextShadow, isNear));
  view.list->AddCircleFilled(*at, radius, faint(tint, isNear));
  if (isNear) label(view, *at, tint, text);
}

void drawLine(const MarkView &view, const Vec3 &a, const Vec3 &b, ImU32 tint) {
  const auto p = view.pixelOf(a), q = view.pixelOf(b);
  if (!p || !q) return;
  const bool isNear = view.isNear(a) || view.isNear(b);
  view.list->AddLine(*p, *q, faint(kTextShadow, isNear), view.frame.theme.px(3.0f));
  view.list->AddLine(*p, *q, faint(tint, isNear), view.frame.theme.px(1.5f));
}

void drawMeasure(MarkView &view, const MeasurementList &list, const MeasurementTools &tools, const Measure &one) {
  std::vector<Vec3> at;
  for (const std::string &name : one.points)
    if (const MeasuredPoint *point = list.set().point(name)) at.push_back(tools.shownAt(*point, view.isInSlice));
  if (at.size() != one.points.size()) return;
  const ImU32 tint = list.selected == one.name ? kSelected : kPoint;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) drawLine(view, at[i], at[i + 1], tint);
  const Vec3 middle = one.isAngle() ? at[1] : 0.5 * (at[0] + at[1]);
  const auto row = list.row(one.name);
  const auto pixel = view.pixelOf(middle);
  if (!row || !pixel || !std::any_of(at.begin(), at.end(), view.isNear)) return;
  const float below = one.isAngle() ? ImGui::GetTextLineHeight() : 0.0f;
  label(view, ImVec2(pixel->x, pixel->y + below), tint, one.name + "  " + row->label());
}

/// The point that a press would take.
void drawHovered(const MarkView &view, const MeasurementList &list, const MeasurementTools &tools) {
  const FrameContext &frame = view.frame;
  const PixelRect &r = view.rect;
  if (!r.contains(frame.mouseX, frame.mouseY) || !frame.activeToolId().starts_with("measure.")) return;
  for (const MeasuredPoint &one : list.set().points) {
    const Vec3 world = tools.shownAt(one, view.isInSlice);
    const auto at = view.pixelOf(world);
    if (one.isHidden || !at || !view.isNear(world)) continue;
    if (std::hypot(at->x - frame.mouseX, at->y - frame.mouseY) > MeasurementTools::kReach_px) continue;
    view.list->AddCircle(*at, frame.theme.px(8.0f), kSelected, 0, frame.theme.px(1.5f));
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    return;
  }
}

/// Slices show a target in the second scan where that scan is shown.
Vec3 shownTarget(const MarkView &view, const Vec3 &target_mm) {
  const ImageViews *images = view.isInSlice ? view.frame.shownImages() : nullptr;
  return images && images->isCompared() ? transformPoint(images->comparison()->worldFromSecond(), target_mm)
                                        : target_mm;
}

void drawAll(MarkView view) {
  const MeasurementList *list = view.frame.services.measurements;
  const MeasurementTools *tools = view.frame.services.measurementTools;
  if (!list || !tools) return;
  for (const Measure &one : list->set().measures)
    if (!one.isHidden) drawMeasure(view, *list, *tools, one);
  for (const MeasuredPoint &one : list->set().points) {
    if (one.isHidden) continue;
    const Vec3 at = tools->shownAt(one, view.isInSlice);
    if (one.target_mm) {
      const Vec3 target = shownTarget(view, *one.target_mm);
      drawLine(view, at, target, kTarget);
      drawPoint(view, target, kTarget, {});
    }
    const auto row = list->row(one.name);
    const std::string moved = row ? row->label() : std::string();
    drawPoint(view, at, list->selected == one.name ? kSelected : kPoint,
              one.name + (moved.empty() ? "" : "  " + moved));
  }
  drawHovered(view, *list, *tools);
  const MeasuredPoint *targeted = list->set().point(tools->targetOf());
  if (const auto follower = tools->follower(); follower && targeted)
    drawLine(view, tools->shownAt(*targeted, view.isInSlice), *follower, kTarget);
  const auto &pending = tools->pending();
  for (std::size_t i = 0; i < pending.size(); ++i) {
    drawPoint(view, pending[i].at_mm, kSelected, {});
    if (i > 0) drawLine(view, pending[i - 1].at_mm, pending[i].at_mm, kSelected);
  }
  if (const auto follower = tools->follower(); follower && !pending.empty()) {
    drawLine(view, pending.back().at_mm, *follower, kSelected);
    if (pending.size() == 1)
      if (const auto at = view.pixelOf(*follower))
        label(view, *at, kSelected,
              shownText({list->length().name == "cm" ? DisplayUnits::Length::cm : DisplayUnits::Length::mm, {}, {}},
                        fmt::format("{:.1f} mm", norm(*follower - pending.back().at_mm))));
  }
}

}  // namespace

void drawMeasurementsInSlice(const SliceCanvas &canvas) {
  const double slab = 0.5 * canvas.view.step() + 1e-6;
  const Vec3 point = canvas.view.worldAt(0, 0), normal = canvas.view.frame().forward;
  drawAll({canvas.frame, canvas.list, [&](const Vec3 &world) { return std::optional(canvas.pixelOf(world)); },
           [=](const Vec3 &world) { return std::abs(dot(world - point, normal)) <= slab; }, canvas.rect, true});
}

void drawMeasurementsInSpace(FrameContext &frame) {
  const PixelRect &r = frame.view;
  if (r.isEmpty()) return;
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  list->PushClipRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), true);
  ImGui::PushFont(frame.theme.small);
  drawAll({frame, list,
           [&](const Vec3 &world) -> std::optional<ImVec2> {
             const Vec3 p = frame.camera.project(world, static_cast<int>(r.w), static_cast<int>(r.h));
             if (p[2] <= 0.0) return std::nullopt;
             return ImVec2(r.x + static_cast<float>(p[0]), r.y + static_cast<float>(p[1]));
           },
           [](const Vec3 &) { return true; }, r});
  ImGui::PopFont();
  list->PopClipRect();
}

}  // namespace c3de::ui
