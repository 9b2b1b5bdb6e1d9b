// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/image_presets.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace c3de::ui {
namespace {

constexpr std::array kWindowLevels{
    WindowLevelPreset{'0', "automatic", "Automatic", {0, 0}},   WindowLevelPreset{'1', "brain", "CT brain", {80, 40}},
    WindowLevelPreset{'2', "lung", "CT lung", {1500, -600}},    WindowLevelPreset{'3', "bone", "CT bone", {2000, 400}},
    WindowLevelPreset{'4', "abdomen", "CT abdomen", {400, 50}}, WindowLevelPreset{'5', "angio", "CT angio", {600, 200}},
    WindowLevelPreset{'6', "liver", "CT liver", {160, 80}},     WindowLevelPreset{'9', "all", "All values", {0, 0}},
};

constexpr std::array kVolumes{
    VolumePresetInfo{VolumePreset::ctBone, "CT bone"},
    VolumePresetInfo{VolumePreset::ctSoftTissue, "CT soft tissue"},
    VolumePresetInfo{VolumePreset::magneticResonance, "MR"},
    VolumePresetInfo{VolumePreset::maximum, "MIP"},
};

// Length of a drag, in pixels, that covers the robust range from end to end.
constexpr double kPixelsPerRange = 400.0;

/// Viridis-like ramp: lightness increases linearly while the hue changes from blue through green to yellow (OKLab).
render::Colour rampColour(double t) {
  const double lightness = 0.28 + 0.62 * t, hue = (280.0 - 175.0 * t) * 3.14159265358979323846 / 180.0;
  const double chroma = 0.11 + 0.05 * t;
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  const auto encoded = [](double linear) {
    const double c = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(c < 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055);
  };
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 1.0f};
}

}  // namespace

std::span<const WindowLevelPreset> windowLevelPresets() { return kWindowLevels; }

WindowLevel automaticWindowLevel(const imaging::ValueRange &range) {
  return {range.high - range.low, 0.5 * (range.low + range.high)};
}

WindowLevel windowLevelOf(const WindowLevelPreset &preset, const imaging::ValueRange &range) {
  if (preset.values.window > 0.0) return preset.values;
  if (preset.key == '9' && range.max > range.min) return {range.max - range.min, 0.5 * (range.min + range.max)};
  return automaticWindowLevel(range);
}

WindowLevel dragged(const WindowLevel &from, double dx_px, double dy_px, const imaging::ValueRange &range) {
  const double perPixel = (range.high - range.low) / kPixelsPerRange;
  return {std::max(from.window + dx_px * perPixel, perPixel), from.level + dy_px * perPixel};
}

std::span<const VolumePresetInfo> volumePresets() { return kVolumes; }

render::VolumeDisplay volumeLook(VolumePreset preset, const imaging::ValueRange &range, double shift) {
  render::VolumeDisplay look;
  const double width = range.high - range.low;
  switch (preset) {
    case VolumePreset::ctBone:
      look.points = {{150.0, {0.55f, 0.25f, 0.15f, 0.0f}},
                     {220.0, {0.72f, 0.42f, 0.28f, 0.06f}},
                     {400.0, {0.92f, 0.80f, 0.62f, 0.45f}},
                     {1200.0, {1.0f, 0.98f, 0.93f, 0.9f}}};
      break;
    case VolumePreset::ctSoftTissue:
      look.points = {{-250.0, {0.6f, 0.35f, 0.25f, 0.0f}}, {-100.0, {0.80f, 0.58f, 0.45f, 0.01f}},
                     {10.0, {0.78f, 0.38f, 0.30f, 0.06f}}, {120.0, {0.85f, 0.45f, 0.35f, 0.15f}},
                     {300.0, {0.95f, 0.88f, 0.72f, 0.5f}}, {1500.0, {1.0f, 0.98f, 0.93f, 0.9f}}};
      break;
    case VolumePreset::magneticResonance: {
      const auto at = [&](double t) { return range.low + t * width; };
      look.points = {{at(0.12), {0.25f, 0.15f, 0.12f, 0.0f}},
                     {at(0.3), {0.55f, 0.38f, 0.32f, 0.03f}},
                     {at(0.6), {0.86f, 0.70f, 0.60f, 0.18f}},
                     {at(1.0), {1.0f, 0.97f, 0.92f, 0.5f}}};
      break;
    }
    case VolumePreset::maximum: look.isMaximum = true; break;
  }
  look.shift = std::clamp(shift, -1.0, 1.0) * width;
  return look;
}

std::span<const render::Colour> overlayColours() {
  static const auto kColours = [] {
    std::array<render::Colour, 64> colours{};
    for (std::size_t i = 0; i < colours.size(); ++i)
      colours[i] = rampColour(static_cast<double>(i) / (colours.size() - 1.0));
    return colours;
  }();
  return kColours;
}

}  // namespace c3de::ui
