// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/figure.h"

#include <cmath>
#include <string>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

FigureSettings column() {
  FigureSettings settings;
  settings.width_mm = 85.0;
  settings.dpi = 300.0;
  return settings;
}

}  // namespace

TEST_CASE("The width of a figure in pixels is its width in inches times the resolution, rounded") {
  CHECK(figureSize(column(), 1.5).width == 1004);  // 1003.94
  CHECK(figureSize(column(), 1.5).height == 669);  // 669.29
  FigureSettings settings = column();
  settings.width_mm = 25.4;
  settings.dpi = 601.0;
  settings.shape = FigureShape::square;
  CHECK(figureSize(settings, 3.0).width == 601);
  CHECK(figureSize(settings, 3.0).height == 601);
  settings.shape = FigureShape::wide;
  CHECK(figureSize(settings, 3.0).height == 338);  // 601 * 9 / 16 = 338.06
}

TEST_CASE("Text of a figure has its size on paper whatever the resolution") {
  FigureSettings settings = column();
  settings.text_pt = 7.2;  // 0.1 inch
  CHECK(figureSize(settings, 1.0).scale * kSmallText_px == Approx(30.0));
  settings.dpi = 600.0;
  CHECK(figureSize(settings, 1.0).scale * kSmallText_px == Approx(60.0));
}

TEST_CASE("A figure that cannot be drawn is refused with the value and what is accepted") {
  const auto problem = [](auto change, int largest) {
    FigureSettings settings = column();
    change(settings);
    return problemOf(settings, 1.5, largest);
  };
  CHECK(problem([](auto &) {}, 16384).empty());
  CHECK(problem([](auto &s) { s.width_mm = 5.0; }, 16384) == "Width: 5 mm; accepted: 10 to 2000 mm");
  CHECK(problem([](auto &s) { s.dpi = 10.0; }, 16384) == "Resolution: 10 dpi; accepted: 50 to 2400 dpi");
  CHECK(problem([](auto &s) { s.text_pt = std::nan(""); }, 16384).find("accepted: 3 to 36 pt") != std::string::npos);
  CHECK(problem(
            [](auto &s) {
              s.width_mm = 400.0;
              s.dpi = 1200.0;
            },
            16384) ==
        "18898 × 12598 pixels; accepted: up to 16384 in each direction, the limit of the graphics (OpenGL) here");
  CHECK(problem(
            [](auto &s) {
              s.width_mm = 400.0;
              s.dpi = 1200.0;
            },
            32768)
            .find("up to 200 million pixels") != std::string::npos);
}

TEST_CASE("Settings of figures are read back, and damaged ones are the usual ones") {
  FigureSettings settings = column();
  settings.isLight = settings.hasAnnotations = false;
  settings.views = FigureViews::coronal;
  settings.shape = FigureShape::fourToThree;
  settings.text_pt = 9.5;
  CHECK(figureSettingsOf(textOf(settings)) == settings);
  CHECK(figureSettingsOf("") == FigureSettings());
  CHECK(figureSettingsOf("{\"width_mm\": ") == FigureSettings());
  CHECK(figureSettingsOf("{\"width_mm\": -3, \"dpi\": \"x\", \"views\": 77, \"shape\": 1.5, \"light\": 3}") ==
        FigureSettings());
  CHECK(figureSettingsOf("{\"width_mm\": 120}").width_mm == 120.0);
}

TEST_CASE("Each size of a screenshot is found again by its id") {
  for (const ScreenshotSize size :
       {ScreenshotSize::view, ScreenshotSize::fullHd, ScreenshotSize::ultraHd, ScreenshotSize::figure})
    CHECK(screenshotSizeOf(idOf(size)) == size);
  CHECK(!screenshotSizeOf("8k").has_value());
}

TEST_CASE("Scale bars of figures are in millimetres, also above a centimetre") {
  CHECK(scaleBarInMillimetres(0.5, 120.0).text == "50 mm");
  CHECK(scaleBarInMillimetres(0.001, 120.0).text == "0.1 mm");
  CHECK(scaleBarInMillimetres(0.0, 120.0).text.empty());
}
