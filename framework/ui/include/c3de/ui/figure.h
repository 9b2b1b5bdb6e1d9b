// SPDX-License-Identifier: Apache-2.0
// Pictures of the views for papers and slides: their size on paper, and what they show.
#pragma once

#include <optional>
#include <string>

#include "c3de/ui/slice_view.h"

namespace c3de::ui {

enum class FigureViews {
  shown,  ///< those of the window
  four,
  space,
  axial,
  sagittal,
  coronal
};
enum class FigureShape {
  shown,  ///< that of the views in the window
  fourToThree,
  square,
  wide  ///< 16:9
};

/// A figure as the user wants it. Value type.
struct FigureSettings {
  double width_mm = 170.0;     ///< on paper: two columns of a journal
  double dpi = 300.0;          ///< pixels per inch
  double text_pt = 7.0;        ///< size of the text on paper, points of 1/72 inch
  bool isLight = true;         ///< background of the 3D view; slices are as in the window
  bool hasAnnotations = true;  ///< names, cross-hair, read-outs and axes
  bool hasCaption = true;      ///< simulated time and forces, where there is a simulation
  FigureViews views = FigureViews::shown;
  FigureShape shape = FigureShape::shown;
  friend bool operator==(const FigureSettings &, const FigureSettings &) = default;
};

inline constexpr double kMillimetresPerInch = 25.4;
/// Height of the text over the slices in the window, pixels.
inline constexpr double kSmallText_px = 12.0;

struct FigureSize {
  int width = 0, height = 0;  ///< pixels
  double height_mm = 0.0;
  double scale = 1.0;  ///< pixels of the figure per pixel of texts and lines
};
/// The width in pixels is width_mm / 25.4 * dpi, rounded.
/// @param shownAspect  width / height of the views in the window, for FigureShape::shown
[[nodiscard]] FigureSize figureSize(const FigureSettings &settings, double shownAspect);
/// What is wrong: which value, and what is accepted. Empty: it can be drawn.
/// @param largestSide_px  of one view, limit of the graphics device
[[nodiscard]] std::string problemOf(const FigureSettings &settings, double shownAspect, int largestSide_px);
/// "1004 × 669 pixels, 85 × 56.6 mm"
[[nodiscard]] std::string sizeText(const FigureSettings &settings, double shownAspect);

/// For the settings of the program. Text that is damaged, or has values that are not accepted, gives the default for
/// these values.
[[nodiscard]] std::string textOf(const FigureSettings &settings);
[[nodiscard]] FigureSettings figureSettingsOf(const std::string &text);

/// What F12 writes.
enum class ScreenshotSize {
  view,     ///< the 3D view with the size that it has in the window
  fullHd,   ///< 1920 × 1080
  ultraHd,  ///< 3840 × 2160
  figure    ///< a figure with the last settings
};
[[nodiscard]] const char *nameOf(ScreenshotSize size);  ///< for the user
[[nodiscard]] const char *idOf(ScreenshotSize size);    ///< for settings and tests
[[nodiscard]] std::optional<ScreenshotSize> screenshotSizeOf(const std::string &id);

/// A scale bar of a figure: as scaleBar(), with its length in mm.
[[nodiscard]] ScaleBar scaleBarInMillimetres(double millimetresPerPixel, double longest_px);

}  // namespace c3de::ui
