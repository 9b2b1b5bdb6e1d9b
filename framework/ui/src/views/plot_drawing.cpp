// SPDX-License-Identifier: Apache-2.0
#include "views/plot_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace c3de::ui {
namespace {

struct Shown {
  const PlotList::Series *series;
  ImU32 tint;
};
/// Curves with the same unit, and the range of their values.
struct Band {
  std::string unit;
  std::vector<Shown> curves;
  double low = 0.0, high = 0.0;
  double least = 0.0, most = 0.0;  ///< without the margin
};

constexpr float kLineWidth_px = 1.5f, kTextGap_px = 4.0f;
constexpr double kMargin = 0.06;  // of the range, above and below

void widen(Band &band, double value) {
  band.low = std::min(band.low, value);
  band.high = std::max(band.high, value);
}

std::vector<Band> bandsOf(const PlotList &plots, bool isLight) {
  std::vector<Band> bands;
  std::size_t number = 0;
  for (const PlotList::Series &series : plots.series()) {
    if (!series.isShown || series.points.empty()) continue;
    auto band = std::find_if(bands.begin(), bands.end(), [&](const Band &b) { return b.unit == series.last.unit; });
    if (band == bands.end()) {
      const double first = series.points.front().value;
      band = bands.insert(band, {series.last.unit, {}, first, first, first, first});
    }
    band->curves.push_back({&series, plotColour(number++, isLight)});
    for (const PlotPoint &point : series.points) widen(*band, point.value);
    if (series.last.limit) widen(*band, *series.last.limit);
  }
  for (Band &band : bands) {
    band.least = band.low;
    band.most = band.high;
    const double range = band.high - band.low;
    const double margin = range > 0.0 ? kMargin * range : std::max(std::abs(band.high), 1e-9) * kMargin;
    band.low -= margin;
    band.high += margin;
  }
  return bands;
}

/// From times and values to pixels.
struct PlotFrame {
  PixelRect rect;
  double begin_s, end_s, low, high;
  [[nodiscard]] float x(double time_s) const {
    return rect.x + rect.w * static_cast<float>((time_s - begin_s) / (end_s - begin_s));
  }
  [[nodiscard]] float y(double value) const {
    return rect.y + rect.h * static_cast<float>(1.0 - (value - low) / (high - low));
  }
};

struct TextColours {
  ImU32 text, dim, line, background, now;
};
TextColours textColoursOf(bool isLight) {
  if (isLight)
    return {IM_COL32(20, 23, 28, 255), IM_COL32(84, 92, 104, 255), IM_COL32(170, 176, 186, 255),
            IM_COL32(247, 248, 250, 255), IM_COL32(40, 110, 125, 255)};
  return {IM_COL32(222, 227, 235, 255), IM_COL32(143, 156, 173, 255), IM_COL32(62, 70, 82, 255), IM_COL32(0, 0, 0, 60),
          IM_COL32(90, 200, 250, 210)};
}

void drawBand(ImDrawList *list, const Band &band, const PlotFrame &at, const TextColours &colours) {
  const PixelRect &r = at.rect;
  const float line = ImGui::GetTextLineHeight();
  list->AddRectFilled(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), colours.background);
  list->AddRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), colours.line);
  const auto rightText = [&](float y, ImU32 tint, const std::string &text) {
    list->AddText(ImVec2(r.x - kTextGap_px - ImGui::CalcTextSize(text.c_str()).x, y), tint, text.c_str());
  };
  rightText(r.y - 1.0f, colours.dim, plotNumber(band.most));
  if (r.h > 2.0f * line) rightText(r.y + r.h - line + 1.0f, colours.dim, plotNumber(band.least));
  if (r.h > 3.2f * line) rightText(r.y + 0.5f * (r.h - line), colours.text, band.unit.empty() ? "1" : band.unit);
  list->PushClipRect(ImVec2(r.x, r.y), ImVec2(r.x + r.w, r.y + r.h), true);
  float legendX = r.x + 2.0f * kTextGap_px;
  std::vector<ImVec2> pixels;
  for (const Shown &shown : band.curves) {
    const PlotList::Series &series = *shown.series;
    if (series.last.limit) {
      const float y = at.y(*series.last.limit);
      for (float x = r.x; x < r.x + r.w; x += 8.0f) list->AddLine(ImVec2(x, y), ImVec2(x + 4.0f, y), shown.tint, 1.0f);
      const std::string text = series.last.limitText;
      list->AddText(ImVec2(r.x + r.w - kTextGap_px - ImGui::CalcTextSize(text.c_str()).x, y - line), shown.tint,
                    text.c_str());
    }
    pixels.clear();
    for (const PlotPoint &point : series.points) pixels.emplace_back(at.x(point.time_s), at.y(point.value));
    if (pixels.size() == 1)
      list->AddCircleFilled(pixels.front(), 2.0f, shown.tint);
    else
      list->AddPolyline(pixels.data(), static_cast<int>(pixels.size()), shown.tint, ImDrawFlags_None, kLineWidth_px);
    list->AddText(ImVec2(legendX, r.y + 2.0f), shown.tint, series.last.label.c_str());
    legendX += ImGui::CalcTextSize(series.last.label.c_str()).x + 4.0f * kTextGap_px;
  }
  list->PopClipRect();
}

PlotReadout readoutAt(const std::vector<Band> &bands, double time_s) {
  PlotReadout out{time_s, {}};
  for (const Band &band : bands)
    for (const Shown &shown : band.curves)
      if (const auto value = shown.series->valueAt(time_s))
        out.lines.push_back(shown.series->last.label + ": " + plotNumber(*value) +
                            (band.unit.empty() ? "" : " " + band.unit));
  return out;
}

}  // namespace

ImU32 plotColour(std::size_t shown, bool isLight) {
  static constexpr std::array<ImU32, 8> kOnDark{IM_COL32(86, 180, 233, 255),  IM_COL32(230, 159, 0, 255),
                                                IM_COL32(0, 200, 150, 255),   IM_COL32(240, 228, 66, 255),
                                                IM_COL32(225, 130, 190, 255), IM_COL32(240, 110, 60, 255),
                                                IM_COL32(140, 150, 255, 255), IM_COL32(200, 205, 212, 255)};
  static constexpr std::array<ImU32, 8> kOnLight{
      IM_COL32(0, 114, 178, 255),  IM_COL32(190, 100, 0, 255), IM_COL32(0, 130, 96, 255),  IM_COL32(140, 120, 0, 255),
      IM_COL32(175, 70, 135, 255), IM_COL32(200, 60, 20, 255), IM_COL32(80, 80, 200, 255), IM_COL32(70, 76, 86, 255)};
  return (isLight ? kOnLight : kOnDark)[shown % kOnDark.size()];
}

std::optional<PlotReadout> drawPlots(ImDrawList *list, const PixelRect &area, const PlotList &plots,
                                     const PlotLook &look) {
  const std::vector<Band> bands = bandsOf(plots, look.isLight);
  if (bands.empty()) return std::nullopt;
  double begin_s = bands.front().curves.front().series->points.front().time_s, end_s = begin_s;
  for (const Band &band : bands)
    for (const Shown &shown : band.curves) {
      begin_s = std::min(begin_s, shown.series->points.front().time_s);
      end_s = std::max(end_s, shown.series->points.back().time_s);
    }
  if (look.now_s) {
    begin_s = std::min(begin_s, *look.now_s);
    end_s = std::max(end_s, *look.now_s);
  }
  end_s = std::max(end_s, begin_s + 1e-6);
  const TextColours colours = textColoursOf(look.isLight);
  const float line = ImGui::GetTextLineHeight(), left = ImGui::CalcTextSize("-1.234e-05").x + 2.0f * kTextGap_px;
  const float gap = 5.0f, bottom = area.y + area.h - line - 2.0f;
  const auto count = static_cast<float>(bands.size());
  const float height = std::max((bottom - area.y - gap * (count - 1.0f)) / count, 4.0f);
  PixelRect rect{area.x + left, area.y, std::max(area.w - left - kTextGap_px, 1.0f), height};
  const PixelRect first = rect;
  for (const Band &band : bands) {
    drawBand(list, band, {rect, begin_s, end_s, band.low, band.high}, colours);
    rect.y += height + gap;
  }
  const PlotFrame all{{first.x, area.y, first.w, bottom - area.y}, begin_s, end_s, 0.0, 1.0};
  list->AddText(ImVec2(first.x, bottom + 1.0f), colours.dim, fmt::format("{:.3f} s", begin_s).c_str());
  const std::string end = fmt::format("{:.3f} s", end_s), name = "simulated time";
  list->AddText(ImVec2(first.x + first.w - ImGui::CalcTextSize(end.c_str()).x, bottom + 1.0f), colours.dim,
                end.c_str());
  list->AddText(ImVec2(first.x + 0.5f * (first.w - ImGui::CalcTextSize(name.c_str()).x), bottom + 1.0f), colours.dim,
                name.c_str());
  if (look.now_s) {
    const float x = all.x(*look.now_s);
    list->AddLine(ImVec2(x, area.y), ImVec2(x, bottom), colours.now, 1.0f);
  }
  if (!look.hoverX || *look.hoverX < first.x || *look.hoverX > first.x + first.w) return std::nullopt;
  list->AddLine(ImVec2(*look.hoverX, area.y), ImVec2(*look.hoverX, bottom), colours.text, 1.0f);
  const double share = static_cast<double>((*look.hoverX - first.x) / first.w);
  return readoutAt(bands, begin_s + share * (end_s - begin_s));
}

}  // namespace c3de::ui
