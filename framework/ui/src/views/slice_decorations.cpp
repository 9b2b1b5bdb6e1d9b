// SPDX-License-Identifier: Apache-2.0
// Decorations over the slices. All are drawn onto the picture of the renderer; positions come from the views.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/geometry/plane_section.h"
#include "c3de/imaging/volume.h"
#include "c3de/render/renderer.h"
#include "logic/curve_runs.h"
#include "views/slice_canvas.h"
#include "views/view_decorations.h"

namespace c3de::ui {
namespace {

constexpr ImU32 kLetter = IM_COL32(240, 214, 120, 255), kInk = IM_COL32(222, 228, 236, 255);
constexpr ImU32 kCross = IM_COL32(90, 200, 250, 210);
constexpr std::array<ImU32, 4> kBorders{IM_COL32(219, 92, 92, 255), IM_COL32(224, 194, 76, 255),
                                        IM_COL32(102, 189, 107, 255), IM_COL32(70, 80, 96, 255)};

void shadowed(ImDrawList *list, ImVec2 at, ImU32 tint, const std::string &text) {
  list->AddText(ImVec2(at.x + 1, at.y + 1), kTextShadow, text.c_str());
  list->AddText(at, tint, text.c_str());
}

/// Text on a dark background: legible over bright tissue and over label colours.
void textOnBackground(ImDrawList *list, ImVec2 at, ImU32 tint, const std::string &text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list->AddRectFilled(ImVec2(at.x - 3, at.y - 1), ImVec2(at.x + size.x + 3, at.y + size.y + 1), IM_COL32(0, 0, 0, 140),
                      3.0f);
  shadowed(list, at, tint, text);
}

ImU32 tintOf(const render::Colour &c, int opacity = 255) {
  const auto byte = [](float v) { return static_cast<int>(std::lround(255.0f * std::clamp(v, 0.0f, 1.0f))); };
  return IM_COL32(byte(c[0]), byte(c[1]), byte(c[2]), opacity);
}

void drawRuns(ImDrawList *list, const std::vector<CurveRun> &runs, ImU32 tint, float width) {
  std::vector<ImVec2> points;
  for (const CurveRun &run : runs) {
    points.clear();
    for (const CurvePoint &p : run.points) points.emplace_back(p.x, p.y);
    list->AddPolyline(points.data(), static_cast<int>(points.size()), tint,
                      run.isClosed ? ImDrawFlags_Closed : ImDrawFlags_None, width);
  }
}

void drawOutlines(const SliceCanvas &canvas, const render::Renderer &renderer) {
  if (!canvas.images.options().showsOutlines || canvas.images.isAtRest()) return;  // they show present positions
  const Vec3 point = canvas.view.worldAt(0, 0), normal = canvas.view.frame().forward;
  std::size_t curves = 0;
  renderer.forEachMesh([&](const render::MeshView &mesh) {
    if (mesh.material.isInside) return;
    // The plane is transformed into the mesh's space instead of every vertex into world space; (v - p) n = 0 with v = M
    // x.
    const Mat4 &m = mesh.worldFromProxy;
    const Vec3 local{m[0] * normal[0] + m[1] * normal[1] + m[2] * normal[2],
                     m[4] * normal[0] + m[5] * normal[1] + m[6] * normal[2],
                     m[8] * normal[0] + m[9] * normal[1] + m[10] * normal[2]};
    const Vec3 origin = transformPoint(imaging::affineInverse(m), point);
    // Bright enough on dark tissue, whatever the surface's own colour.
    render::Colour colour = mesh.material.colour;
    const float most = std::max({colour[0], colour[1], colour[2], 0.05f});
    for (std::size_t k = 0; k < 3; ++k) colour[k] = colour[k] / most;
    for (const geometry::Polyline &curve : geometry::planeSection(mesh.positions, mesh.triangles, origin, local)) {
      ++curves;
      std::vector<CurvePoint> pixels;
      pixels.reserve(curve.points.size());
      for (const Vec3 &p : curve.points) {
        const ImVec2 pixel = canvas.pixelOf(transformPoint(m, p));
        pixels.push_back({pixel.x, pixel.y});
      }
      const std::vector<CurveRun> runs = curveRuns(pixels, curve.isClosed);
      drawRuns(canvas.list, runs, kTextShadow, canvas.px(3.0f));
      drawRuns(canvas.list, runs, tintOf(colour), canvas.px(1.6f));
    }
  });
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".outlines", std::to_string(curves));
}

/// Markers of tools as seen in the slice: fainter off its plane, spheres as their intersection with it.
void drawMarks(const SliceCanvas &canvas, const render::Renderer &renderer) {
  const Vec3 point = canvas.view.worldAt(0, 0), normal = canvas.view.frame().forward;
  const double slab = 0.5 * canvas.view.step() + 1e-6;
  std::size_t inPlane = 0, beside = 0;
  renderer.forEachMark([&](const render::MarkView &mark) {
    const auto world = [&](const render::Vec3f &p) { return transformPoint(mark.worldFromProxy, {p[0], p[1], p[2]}); };
    const auto away = [&](const Vec3 &p) { return dot(p - point, normal); };
    const auto tint = [&](bool isHere) {
      ++(isHere ? inPlane : beside);
      return tintOf(mark.material.colour, isHere ? 255 : 115);
    };
    switch (mark.kind) {
      case render::MarkView::Kind::lines:
        for (std::size_t i = 0; i + 1 < mark.positions.size(); i += 2) {
          const Vec3 a = world(mark.positions[i]), b = world(mark.positions[i + 1]);
          const bool isHere = std::min(std::abs(away(a)), std::abs(away(b))) <= slab || away(a) * away(b) < 0.0;
          canvas.list->AddLine(canvas.pixelOf(a), canvas.pixelOf(b), tint(isHere), canvas.px(mark.width_px));
        }
        break;
      case render::MarkView::Kind::spheres: {
        const Mat4 &m = mark.worldFromProxy;
        const double scale = norm(Vec3{m[0], m[1], m[2]}), radius = scale * mark.radius;
        for (const render::Vec3f &p : mark.positions) {
          const Vec3 middle = world(p);
          const double half = radius * radius - away(middle) * away(middle);
          if (!(half > 0.0)) continue;
          const auto pixels = static_cast<float>(std::sqrt(half) / canvas.view.millimetresPerPixel());
          canvas.list->AddCircle(canvas.pixelOf(middle), pixels, tint(true), 0, canvas.px(1.6f));
        }
        break;
      }
      case render::MarkView::Kind::label: {
        const Vec3 at = world(mark.positions.front());
        const ImVec2 pixel = canvas.pixelOf(at), size = ImGui::CalcTextSize(mark.text.c_str());
        textOnBackground(canvas.list, ImVec2(pixel.x - 0.5f * size.x, pixel.y - size.y - canvas.px(6.0f)),
                         tint(std::abs(away(at)) <= slab), mark.text);
        break;
      }
    }
  });
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".marks",
                                fmt::format("{} in the plane, {} beside it", inPlane, beside));
}

void drawCrossHair(const SliceCanvas &canvas) {
  const bool isShown = canvas.frame.hasAnnotations() && canvas.images.options().showsCrossHair &&
                       canvas.view.isOnSlice(canvas.images.crossHair());
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".cross_hair",
                                isShown ? "shown" : "hidden");
  if (!isShown) return;
  const ImVec2 at = canvas.pixelOf(canvas.images.crossHair());
  const PixelRect &r = canvas.rect;
  const float gap = canvas.px(6.0f);
  const auto line = [&](ImVec2 a, ImVec2 b) { canvas.list->AddLine(a, b, kCross, 1.0f); };
  if (at.y >= r.y && at.y < r.y + r.h) {
    line(ImVec2(r.x, at.y), ImVec2(std::min(at.x - gap, r.x + r.w), at.y));
    line(ImVec2(std::max(at.x + gap, r.x), at.y), ImVec2(r.x + r.w, at.y));
  }
  if (at.x >= r.x && at.x < r.x + r.w) {
    line(ImVec2(at.x, r.y), ImVec2(at.x, std::min(at.y - gap, r.y + r.h)));
    line(ImVec2(at.x, std::max(at.y + gap, r.y)), ImVec2(at.x, r.y + r.h));
  }
}

void drawLetters(const SliceCanvas &canvas) {
  const SliceFrame &f = canvas.view.frame();
  const PixelRect &r = canvas.rect;
  const std::string left = orientationLetters(-1.0 * f.right), right = orientationLetters(f.right),
                    top = orientationLetters(-1.0 * f.down), bottom = orientationLetters(f.down);
  const float edge = canvas.px(6.0f);
  ImGui::PushFont(canvas.frame.theme.bold);
  const auto size = [](const std::string &text) { return ImGui::CalcTextSize(text.c_str()); };
  shadowed(canvas.list, ImVec2(r.x + edge, r.y + 0.5f * (r.h - size(left).y)), kLetter, left);
  shadowed(canvas.list, ImVec2(r.x + r.w - edge - size(right).x, r.y + 0.5f * (r.h - size(right).y)), kLetter, right);
  shadowed(canvas.list, ImVec2(r.x + 0.5f * (r.w - size(top).x), r.y + edge), kLetter, top);
  // Above the line of the read-out.
  shadowed(canvas.list,
           ImVec2(r.x + 0.5f * (r.w - size(bottom).x), r.y + r.h - edge - canvas.readoutHeight() - size(bottom).y),
           kLetter, bottom);
  ImGui::PopFont();
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".letters",
                                left + "|" + right + "|" + top + "|" + bottom);
}

void drawScaleBar(const SliceCanvas &canvas) {
  const PixelRect &r = canvas.rect;
  const double perPixel = canvas.view.millimetresPerPixel();
  const ScaleBar bar =
      canvas.frame.figure ? scaleBarInMillimetres(perPixel, 0.25 * r.w) : scaleBar(perPixel, 0.25 * r.w);
  if (bar.text.empty()) return;
  const auto length = static_cast<float>(bar.length_px);
  const float x1 = r.x + r.w - canvas.px(14.0f), x0 = x1 - length,
              y = r.y + r.h - canvas.px(14.0f) - canvas.readoutHeight(), tick = canvas.px(4.0f);
  for (const auto &[tint, offset] : {std::pair{kTextShadow, 1.0f}, {kInk, 0.0f}}) {
    canvas.list->AddLine(ImVec2(x0 + offset, y + offset), ImVec2(x1 + offset, y + offset), tint, canvas.px(1.5f));
    for (const float x : {x0, x1})
      canvas.list->AddLine(ImVec2(x + offset, y - tick + offset), ImVec2(x + offset, y + tick + offset), tint,
                           canvas.px(1.5f));
  }
  const float width = ImGui::CalcTextSize(bar.text.c_str()).x;
  shadowed(canvas.list, ImVec2(0.5f * (x0 + x1 - width), y - tick - ImGui::GetTextLineHeight() - 1), kInk, bar.text);
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".scale", bar.text);
}

/// The colour bar of the overlay.
void drawOverlayLegend(const SliceCanvas &canvas) {
  const ImageOptions &options = canvas.images.options();
  const std::string key = std::string(paneName(canvas.pane)) + ".legend";
  const bool isShown =
      canvas.images.showsDisplacement() && (options.overlay == Overlay::shift || canvas.images.shownField());
  const Quantity quantity = canvas.images.overlayQuantity();
  const OverlayRange range = canvas.images.overlayRange();
  canvas.frame.automation.value("image", key,
                                isShown ? quantity.title + " " + rangeText(range, quantity.unit) : std::string("none"));
  if (!isShown) return;
  const auto colours = overlayColours();
  const float h = std::min(0.45f * canvas.rect.h, canvas.px(140.0f)), w = canvas.px(10.0f);
  const float x = canvas.rect.x + canvas.px(24.0f), y0 = canvas.rect.y + 0.5f * (canvas.rect.h - h);
  constexpr std::size_t kPieces = 32;
  for (std::size_t i = 0; i < kPieces; ++i) {
    const auto colour = [&](std::size_t k) { return tintOf(colours[k * (colours.size() - 1) / kPieces]); };
    const float top = y0 + h * (1.0f - static_cast<float>(i + 1) / kPieces),
                bottom = y0 + h * (1.0f - static_cast<float>(i) / kPieces);
    canvas.list->AddRectFilledMultiColor(ImVec2(x, top), ImVec2(x + w, bottom), colour(i + 1), colour(i + 1), colour(i),
                                         colour(i));
  }
  const float line = ImGui::GetTextLineHeight();
  const auto withUnit = [&](double value) {
    return fmt::format("{:.4g}{}{}", value, quantity.unit.empty() ? "" : " ", quantity.unit);
  };
  shadowed(canvas.list, ImVec2(x + w + canvas.px(4.0f), y0 - 0.5f * line), kInk, withUnit(range.high));
  shadowed(canvas.list, ImVec2(x + w + canvas.px(4.0f), y0 + h - 0.5f * line), kInk, withUnit(range.low));
  if (range.low < 0.0 && range.high > 0.0) {
    const float zero = y0 + h * static_cast<float>(range.high / (range.high - range.low));
    shadowed(canvas.list, ImVec2(x + w + canvas.px(4.0f), zero - 0.5f * line), kInk, "0");
  }
  shadowed(canvas.list, ImVec2(x, y0 - 1.7f * line), kInk, quantity.title);
}

/// Legend of the hatching of missing tissue.
void drawMissingLegend(const SliceCanvas &canvas) {
  const std::string &text = canvas.images.missingText();
  canvas.frame.automation.value("image", std::string(paneName(canvas.pane)) + ".missing", text.empty() ? "none" : text);
  if (text.empty() || canvas.images.handles().missing.isNull()) return;
  const PixelRect &r = canvas.rect;
  const float line = ImGui::GetTextLineHeight(), size = 0.8f * line, edge = canvas.px(8.0f);
  const ImVec2 at(r.x + edge, r.y + r.h - edge - canvas.readoutHeight() - 1.2f * line);
  const ImU32 tint = IM_COL32(255, 115, 242, 255);
  canvas.list->AddRectFilled(at, ImVec2(at.x + size, at.y + size), IM_COL32(90, 40, 85, 255));
  for (const float part : {0.0f, 0.5f})
    canvas.list->AddLine(ImVec2(at.x + part * size, at.y), ImVec2(at.x + size, at.y + (1.0f - part) * size), tint,
                         canvas.px(1.5f));
  canvas.list->AddRect(at, ImVec2(at.x + size, at.y + size), tint);
  textOnBackground(canvas.list, ImVec2(at.x + size + canvas.px(6.0f), at.y - 0.1f * line), kInk,
                   elided(text, r.w - 2 * edge - size - canvas.px(6.0f)));
}

/// Of a figure without a 3D view, in its first slice.
void drawCaption(const SliceCanvas &canvas) {
  const FigureLook *figure = canvas.frame.figure;
  if (!figure || figure->caption.empty() || !canvas.frame.view.isEmpty()) return;
  for (const Pane pane : kSlicePanes) {
    if (canvas.frame.panes[static_cast<std::size_t>(pane)].isEmpty()) continue;
    if (pane != canvas.pane) return;
    break;
  }
  const PixelRect &r = canvas.rect;
  const float edge = canvas.px(8.0f), line = 1.4f * ImGui::GetTextLineHeight();
  const float above = canvas.images.handles().missing.isNull() ? 1.0f : 2.0f;
  textOnBackground(canvas.list, ImVec2(r.x + edge, r.y + r.h - edge - canvas.readoutHeight() - above * line), kInk,
                   figure->caption);
}

/// Left and right are a matter of safety: the convention is stated in every view whose orientation it changes.
void drawConvention(const SliceCanvas &canvas) {
  if (canvas.pane == Pane::sagittal) return;
  const PixelRect &r = canvas.rect;
  const std::string badge =
      canvas.images.options().convention == Convention::radiological ? "radiological" : "neurological";
  const float edge = canvas.px(8.0f);
  shadowed(canvas.list, ImVec2(r.x + r.w - edge - ImGui::CalcTextSize(badge.c_str()).x, r.y + edge), kLetter, badge);
}

void drawTexts(const SliceCanvas &canvas) {
  const PixelRect &r = canvas.rect;
  const ImageOptions &options = canvas.images.options();
  const float edge = canvas.px(8.0f), line = ImGui::GetTextLineHeight() + canvas.px(2.0f);
  const std::string name = paneName(canvas.pane);
  const std::string slice = fmt::format("{}  {} / {}", name, canvas.view.slice() + 1, canvas.view.sliceCount());
  textOnBackground(canvas.list, ImVec2(r.x + edge, r.y + edge), kBorders[static_cast<std::size_t>(canvas.pane)], slice);
  const std::string windowLevel =
      fmt::format("W {:.5g}  L {:.5g}", options.windowLevel.window, options.windowLevel.level);
  textOnBackground(canvas.list, ImVec2(r.x + edge, r.y + edge + line), kInk, windowLevel);
  float next = r.y + edge + 2 * line;
  const std::string second = canvas.images.isCompared() ? canvas.images.comparison()->text() : std::string();
  if (!second.empty()) {
    textOnBackground(canvas.list, ImVec2(r.x + edge, next), kInk, elided("over it: " + second, r.w - 2 * edge));
    next += line;
  }
  if (options.isWindowLevelMode) {
    shadowed(canvas.list, ImVec2(r.x + edge, next), kLetter, "drag: window/level");
    next += line;
  }
  if (canvas.images.isPicking())
    shadowed(canvas.list, ImVec2(r.x + edge, next), kLetter, "click: this part (Esc: none)");
  // Position under the mouse, otherwise the cross-hair.
  const bool isHere = r.contains(canvas.frame.mouseX, canvas.frame.mouseY);
  const Vec3 world =
      isHere ? canvas.view.worldAt(canvas.frame.mouseX - r.x, canvas.frame.mouseY - r.y) : canvas.images.crossHair();
  const Readout readout = canvas.images.readout(world);
  float y = r.y + r.h - edge - canvas.readoutHeight();
  for (const std::string &text : {readout.placeText(), readout.tissueText()}) {
    if (!text.empty())
      textOnBackground(canvas.list, ImVec2(r.x + edge, y),
                       isHere ? kInk : ImGui::GetColorU32(paletteOf(ThemeKind::dark).dim),
                       elided(text, r.w - 2 * edge));
    y += line;
  }

  AutomationState &automation = canvas.frame.automation;
  automation.value("image", name + ".slice", std::to_string(canvas.view.slice()));
  automation.value("image", name + ".readout", readout.text());
  automation.value("image", name + ".scale_mm_per_px", fmt::format("{:.6g}", canvas.view.millimetresPerPixel()));
}

/// A small cross in the 3D view, in front of everything.
void drawCrossInSpace(FrameContext &frame, const ImageViews &images) {
  const PixelRect &r = frame.view;
  if (r.isEmpty() || !images.options().showsCrossHair || !frame.hasAnnotations()) return;
  const auto pixelOf = [&](const Vec3 &world) {
    const Vec3 p = frame.camera.project(world, static_cast<int>(r.w), static_cast<int>(r.h));
    return std::pair(ImVec2(r.x + static_cast<float>(p[0]), r.y + static_cast<float>(p[1])), p[2]);
  };
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  const double arm = 18.0 * frame.camera.millimetresPerPixel(images.crossHair(), static_cast<int>(r.h));
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 along{};
    along[a] = arm;
    const auto [p, depthP] = pixelOf(images.crossHair() - along);
    const auto [q, depthQ] = pixelOf(images.crossHair() + along);
    if (depthP > 0.0 && depthQ > 0.0) list->AddLine(p, q, kCross, frame.theme.px(1.5f));
  }
}

}  // namespace

void drawSliceDecorations(FrameContext &frame, const render::Renderer &renderer) {
  const ImageViews *images = frame.shownImages();
  if (!images) return;
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  ImGui::PushFont(frame.theme.small);
  for (const Pane pane : kSlicePanes) {
    const PixelRect &r = frame.panes[static_cast<std::size_t>(pane)];
    if (r.isEmpty()) continue;
    list->PushClipRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), true);
    const SliceCanvas canvas{frame, *images, pane, r, images->view(pane), list};
    drawOutlines(canvas, renderer);
    drawRegion(canvas);
    drawBrush(canvas);
    drawCrossHair(canvas);
    drawLetters(canvas);
    drawScaleBar(canvas);
    drawOverlayLegend(canvas);
    drawMissingLegend(canvas);
    drawConvention(canvas);
    if (frame.hasAnnotations()) drawTexts(canvas);
    drawCaption(canvas);
    drawMarks(canvas, renderer);
    drawMeasurementsInSlice(canvas);
    if (frame.hasAnnotations())
      list->AddRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), kBorders[static_cast<std::size_t>(pane)], 0.0f, 0,
                    1.0f);
    list->PopClipRect();
  }
  if (!frame.view.isEmpty()) {
    const PixelRect &r = frame.view;
    list->PushClipRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), true);
    drawCrossInSpace(frame, *images);
    drawRegionInSpace(frame);
    list->PopClipRect();
  }
  ImGui::PopFont();

  const ImageOptions &options = images->options();
  const Vec3 &cross = images->crossHair();
  AutomationState &automation = frame.automation;
  automation.value("image", "name", images->image()->name);
  automation.value("image", "window", fmt::format("{:.6g}", options.windowLevel.window));
  automation.value("image", "level", fmt::format("{:.6g}", options.windowLevel.level));
  automation.value("image", "cross_hair", fmt::format("{:.3f} {:.3f} {:.3f}", cross[0], cross[1], cross[2]));
  automation.value("image", "preview",
                   images->handles().preview.isNull() ? "none"
                   : options.showsPreview             ? "shown"
                                                      : "hidden");
  const Comparison *second = images->comparison();
  automation.value("comparison", "name", second && second->image() ? second->image()->name : "none");
  if (images->isCompared()) {
    const geometry::RigidPose &pose = second->pose();
    const auto text = [](const Vec3 &v) { return fmt::format("{:.6f} {:.6f} {:.6f}", v[0], v[1], v[2]); };
    automation.value("comparison", "translation_mm", text(pose.translation_mm));
    automation.value("comparison", "rotation_deg", text(pose.rotation_deg));
    automation.value("comparison", "text", second->text());
    automation.value("comparison", "mean_mm",
                     second->alignment() ? fmt::format("{:.9g}", second->alignment()->mean_mm) : std::string("none"));
  }
  automation.value("image", "picking", images->isPicking() ? "on" : "off");
  automation.value("image", "layout", images->maximised() ? paneName(*images->maximised()) : "four");
}

}  // namespace c3de::ui
