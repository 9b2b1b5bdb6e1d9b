// SPDX-License-Identifier: Apache-2.0
// Layout of bar, numbers and text of a legend: at the right edge, vertically centred.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "label_pass.h"
#include "view_math.h"

namespace c3de::render {
namespace {

constexpr float kMargin_px = 12.0f, kPadding_px = 12.0f, kGap_px = 8.0f;
constexpr float kBarWidth_px = 18.0f, kLongestBar_px = 220.0f, kShortestBar_px = 48.0f;
constexpr int kMaxTicks = 6;
constexpr float kPartOfWidth = 0.6f;  // a legend that would cover more of the picture is omitted
struct Inks {
  Rgba8 ground, text, dim, tick;
};
constexpr Inks kOnDark{{20, 23, 28, 205}, {232, 235, 240, 255}, {168, 176, 188, 255}, {232, 235, 240, 150}};
constexpr Inks kOnLight{{255, 255, 255, 215}, {20, 23, 28, 255}, {70, 76, 86, 255}, {20, 23, 28, 170}};

struct Tick {
  double value;
  std::string text;
};

/// Just enough digits to distinguish multiples of the step.
std::string tickText(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0.0;
  char text[40];
  if (std::max(std::abs(value), step) >= 1e5 || step < 1e-4) {
    std::snprintf(text, sizeof text, "%.3g", value);
  } else {
    const int most = std::clamp(static_cast<int>(std::ceil(-std::log10(step))) + 2, 0, 6);
    const auto isWhole = [](double x) { return std::abs(x - std::round(x)) < 1e-6; };
    int decimals = 0;
    while (decimals < most && !isWhole(step * std::pow(10.0, decimals))) ++decimals;
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
  }
  return text;
}

/// Multiples of 1, 2, 2.5 or 5 times a power of ten, three to six of them, and the upper end.
std::vector<Tick> ticksOf(double low, double high) {
  const double range = high - low, power = std::pow(10.0, std::floor(std::log10(range / kMaxTicks)));
  double step = 10.0 * power;
  for (const double factor : {1.0, 2.0, 2.5, 5.0})
    if (range / (factor * power) <= kMaxTicks - 1 + 1e-9) {
      step = factor * power;
      break;
    }
  std::vector<Tick> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * range; ++k)
    ticks.push_back({k * step, tickText(k * step, step)});
  if (ticks.empty() || high - ticks.back().value > 1e-6 * range) {
    if (!ticks.empty() && high - ticks.back().value < 0.5 * step) ticks.pop_back();
    char text[40];
    std::snprintf(text, sizeof text, "%.4g", high);
    ticks.push_back({high, text});
  }
  return ticks;
}

std::vector<std::u32string> linesOf(const std::string &text) {
  std::vector<std::u32string> lines;
  const std::u32string all = decodeUtf8(text);
  for (std::size_t begin = 0; begin <= all.size() && !all.empty();) {
    const std::size_t end = std::min(all.find(U'\n', begin), all.size());
    lines.push_back(all.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace

void LabelPass::addRectangle(float x0, float y0, float x1, float y1, Rgba8 bottom, Rgba8 top) {
  const Vertex a{x0, y0, -1.0f, -1.0f, bottom}, b{x1, y0, -1.0f, -1.0f, bottom};
  const Vertex c{x1, y1, -1.0f, -1.0f, top}, d{x0, y1, -1.0f, -1.0f, top};
  vertices_.insert(vertices_.end(), {a, b, c, a, c, d});
}

void LabelPass::layOutLegends(const Frame &frame) {
  if (legends_.empty()) return;
  const auto [width, height] = frame.scaledSize();
  const Inks &inks = frame.isLight ? kOnLight : kOnDark;
  const auto count = static_cast<float>(legends_.size());
  const float line = lineHeight(), room = (height - kMargin_px) / count - kMargin_px;
  float below = 0.5f * (height + count * (room + kMargin_px) - kMargin_px);  // top of the next
  for (const Legend *legend : legends_) {
    const float top = below;
    below -= room + kMargin_px;
    std::vector<std::u32string> head = linesOf(legend->title), foot = linesOf(legend->note);
    if (!legend->unit.empty()) head.push_back(decodeUtf8("in " + legend->unit));
    const float words = (static_cast<float>(head.size() + foot.size()) + 0.5f) * line;
    const float bar = std::min(kLongestBar_px, std::floor(room - words - 2.0f * kPadding_px - 2.0f * kGap_px));
    if (bar < kShortestBar_px) continue;

    const std::vector<Tick> ticks = ticksOf(legend->low, legend->high);
    float tickWidth = 0.0f, wide = 0.0f;
    for (const Tick &tick : ticks) tickWidth = std::max(tickWidth, widthOf(decodeUtf8(tick.text)));
    for (const auto *lines : {&head, &foot})
      for (const std::u32string &text : *lines) wide = std::max(wide, widthOf(text));
    wide = std::max(wide, kBarWidth_px + 2.0f * kGap_px + tickWidth);
    if (wide + 2.0f * kPadding_px > kPartOfWidth * width) continue;

    // y is up.
    const float boxHeight = words + bar + 2.0f * kPadding_px + 2.0f * kGap_px;
    const float right = width - kMargin_px, left = std::floor(right - wide - 2.0f * kPadding_px);
    const float upper = std::floor(top - 0.5f * (room - boxHeight)), x = left + kPadding_px;
    addRectangle(left, upper - boxHeight, right, upper, inks.ground, inks.ground);
    float base = upper - kPadding_px - ascent();
    for (std::size_t i = 0; i < head.size(); ++i, base -= line)
      addLine(head[i], x, base, i + 1 == head.size() && !legend->unit.empty() ? inks.dim : inks.text);
    const float barTop = std::floor(base + ascent() - kGap_px - 0.25f * line), barBottom = barTop - bar;
    const std::size_t bands = legend->colours.size() - 1;
    for (std::size_t i = 0; i < bands; ++i) {
      const float band = bar / static_cast<float>(bands), y = barBottom + band * static_cast<float>(i);
      addRectangle(x, y, x + kBarWidth_px, y + band, toRgba8(legend->colours[i]), toRgba8(legend->colours[i + 1]));
    }
    for (const Tick &tick : ticks) {
      const float y = barBottom + bar * static_cast<float>((tick.value - legend->low) / (legend->high - legend->low));
      addRectangle(x + kBarWidth_px, std::floor(y - 0.5f), x + kBarWidth_px + 5.0f, std::floor(y + 0.5f), inks.tick,
                   inks.tick);
      addLine(decodeUtf8(tick.text), x + kBarWidth_px + 2.0f * kGap_px, y - 0.35f * ascent(), inks.text);
    }
    base = barBottom - kGap_px - 0.25f * line - ascent();
    for (std::size_t i = 0; i < foot.size(); ++i, base -= line) addLine(foot[i], x, base, inks.dim);
  }
}

}  // namespace c3de::render
