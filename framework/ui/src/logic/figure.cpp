// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "c3de/core/text.h"

namespace c3de::ui {
namespace {

struct Range {
  const char *what;
  double low, high;
  const char *unit;
};
constexpr Range kWidth{"Width", 10.0, 2000.0, "mm"}, kResolution{"Resolution", 50.0, 2400.0, "dpi"},
    kTextSize{"Text", 3.0, 36.0, "pt"};
constexpr double kMaxPixels = 200e6;  // the encoder of PNG counts bytes in 32 bits
constexpr double kPointsPerInch = 72.0;
constexpr int kMinSide_px = 16;

constexpr std::array<const char *, 4> kScreenshotIds{"view", "full_hd", "ultra_hd", "figure"},
    kScreenshotNames{"3D view, as in the window", "3D view, 1920 × 1080", "3D view, 3840 × 2160",
                     "Figure, last settings"};

bool accepts(const Range &range, double value) { return value >= range.low && value <= range.high; }

std::string outsideOf(const Range &range, double value) {
  return fmt::format("{}: {} {}; accepted: {} to {} {}", range.what, formatNumber(value), range.unit,
                     formatNumber(range.low), formatNumber(range.high), range.unit);
}

double aspectOf(const FigureSettings &settings, double shownAspect) {
  switch (settings.shape) {
    case FigureShape::fourToThree: return 4.0 / 3.0;
    case FigureShape::square: return 1.0;
    case FigureShape::wide: return 16.0 / 9.0;
    default: return shownAspect > 0.0 && std::isfinite(shownAspect) ? shownAspect : 4.0 / 3.0;
  }
}

int pixels(double value) { return static_cast<int>(std::lround(std::clamp(value, 1.0, 1e8))); }

void readNumber(const nlohmann::json &from, const char *key, const Range &range, double &value) {
  const auto found = from.find(key);
  if (found != from.end() && found->is_number() && accepts(range, found->get<double>())) value = found->get<double>();
}

void readFlag(const nlohmann::json &from, const char *key, bool &value) {
  const auto found = from.find(key);
  if (found != from.end() && found->is_boolean()) value = found->get<bool>();
}

template <typename Enum>
void readChoice(const nlohmann::json &from, const char *key, Enum last, Enum &value) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_number_integer()) return;
  const auto number = found->get<std::int64_t>();
  if (number >= 0 && number <= static_cast<std::int64_t>(last)) value = static_cast<Enum>(number);
}

}  // namespace

FigureSize figureSize(const FigureSettings &settings, double shownAspect) {
  const double aspect = aspectOf(settings, shownAspect), perMillimetre = settings.dpi / kMillimetresPerInch;
  FigureSize size;
  size.width = pixels(settings.width_mm * perMillimetre);
  size.height_mm = settings.width_mm / aspect;
  size.height = pixels(size.height_mm * perMillimetre);
  size.scale = settings.text_pt / kPointsPerInch * settings.dpi / kSmallText_px;
  return size;
}

std::string problemOf(const FigureSettings &settings, double shownAspect, int largestSide_px) {
  if (!accepts(kWidth, settings.width_mm)) return outsideOf(kWidth, settings.width_mm);
  if (!accepts(kResolution, settings.dpi)) return outsideOf(kResolution, settings.dpi);
  if (!accepts(kTextSize, settings.text_pt)) return outsideOf(kTextSize, settings.text_pt);
  const FigureSize size = figureSize(settings, shownAspect);
  if (std::min(size.width, size.height) < kMinSide_px)
    return fmt::format("{} × {} pixels; accepted: at least {} in each direction", size.width, size.height, kMinSide_px);
  if (largestSide_px > 0 && std::max(size.width, size.height) > largestSide_px)
    return fmt::format("{} × {} pixels; accepted: up to {} in each direction, the limit of the graphics (OpenGL) here",
                       size.width, size.height, largestSide_px);
  if (static_cast<double>(size.width) * size.height > kMaxPixels)
    return fmt::format("{} × {} pixels; accepted: up to {:.0f} million pixels", size.width, size.height,
                       1e-6 * kMaxPixels);
  return {};
}

std::string sizeText(const FigureSettings &settings, double shownAspect) {
  const FigureSize size = figureSize(settings, shownAspect);
  return fmt::format("{} × {} pixels, {:.4g} × {:.4g} mm", size.width, size.height, settings.width_mm, size.height_mm);
}

std::string textOf(const FigureSettings &settings) {
  const nlohmann::json text = {{"width_mm", settings.width_mm},
                               {"dpi", settings.dpi},
                               {"text_pt", settings.text_pt},
                               {"light", settings.isLight},
                               {"notes", settings.hasAnnotations},
                               {"caption", settings.hasCaption},
                               {"views", static_cast<int>(settings.views)},
                               {"shape", static_cast<int>(settings.shape)}};
  return text.dump();
}

FigureSettings figureSettingsOf(const std::string &text) {
  FigureSettings settings;
  const nlohmann::json from = nlohmann::json::parse(text, nullptr, false);
  if (!from.is_object()) return settings;
  readNumber(from, "width_mm", kWidth, settings.width_mm);
  readNumber(from, "dpi", kResolution, settings.dpi);
  readNumber(from, "text_pt", kTextSize, settings.text_pt);
  readFlag(from, "light", settings.isLight);
  readFlag(from, "notes", settings.hasAnnotations);
  readFlag(from, "caption", settings.hasCaption);
  readChoice(from, "views", FigureViews::coronal, settings.views);
  readChoice(from, "shape", FigureShape::wide, settings.shape);
  return settings;
}

const char *nameOf(ScreenshotSize size) { return kScreenshotNames[static_cast<std::size_t>(size)]; }
const char *idOf(ScreenshotSize size) { return kScreenshotIds[static_cast<std::size_t>(size)]; }

std::optional<ScreenshotSize> screenshotSizeOf(const std::string &id) {
  const auto found = std::find(kScreenshotIds.begin(), kScreenshotIds.end(), id);
  if (found == kScreenshotIds.end()) return std::nullopt;
  return static_cast<ScreenshotSize>(found - kScreenshotIds.begin());
}

ScaleBar scaleBarInMillimetres(double millimetresPerPixel, double longest_px) {
  ScaleBar bar = scaleBar(millimetresPerPixel, longest_px);
  if (!bar.text.empty()) bar.text = formatNumber(bar.length_mm) + " mm";
  return bar;
}

}  // namespace c3de::ui
