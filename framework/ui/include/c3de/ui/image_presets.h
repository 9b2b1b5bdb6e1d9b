// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "c3de/imaging/statistics.h"
#include "c3de/render/image_renderer.h"

namespace c3de::ui {

struct WindowLevel {
  double window = 1.0, level = 0.5;
  friend bool operator==(const WindowLevel &, const WindowLevel &) = default;
};

struct WindowLevelPreset {
  std::uint32_t key;  ///< digit
  const char *id, *name;
  WindowLevel values;  ///< HU; window 0: determined from the image
};
/// Presets of computed tomography, 0 for automatic, 9 for all values.
[[nodiscard]] std::span<const WindowLevelPreset> windowLevelPresets();
/// Excludes the lowest and highest 0.1 % of the voxels.
[[nodiscard]] WindowLevel automaticWindowLevel(const imaging::ValueRange &range);
[[nodiscard]] WindowLevel windowLevelOf(const WindowLevelPreset &preset, const imaging::ValueRange &range);
/// By a mouse drag: to the right the window widens, upwards the image becomes brighter. Steps are scaled to the image's
/// values; the window stays positive.
[[nodiscard]] WindowLevel dragged(const WindowLevel &from, double dx_px, double dy_px,
                                  const imaging::ValueRange &range);

enum class VolumePreset : std::uint32_t { ctBone, ctSoftTissue, magneticResonance, maximum };
struct VolumePresetInfo {
  VolumePreset preset;
  const char *name;
};
[[nodiscard]] std::span<const VolumePresetInfo> volumePresets();
/// CT presets are in HU; the others are scaled to the image's values.
/// @param shift  -1 … 1: moves the transfer function over the range of the image's values
[[nodiscard]] render::VolumeDisplay volumeLook(VolumePreset preset, const imaging::ValueRange &range, double shift);

/// From dark blue to yellow with steadily increasing lightness, so that it is readable with every type of colour
/// vision.
[[nodiscard]] std::span<const render::Colour> overlayColours();

}  // namespace c3de::ui
