// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// Numbers of the command line: decimal, with a point regardless of the locale, finite, and without trailing text. The
/// error states the accepted range. @param unit  "s", or empty
[[nodiscard]] Expected<double> parseDecimal(std::string_view text, double least, double most, std::string_view unit);
/// Same, without a point or an exponent.
[[nodiscard]] Expected<long long> parseWhole(std::string_view text, long long least, long long most);

struct PictureSize {
  int width = 0, height = 0;
};
/// "1280x720"
[[nodiscard]] Expected<PictureSize> parseSize(std::string_view text);

struct CameraAngles {
  double azimuth_deg = 0.0, elevation_deg = 0.0;
};
/// "30,20": azimuth and elevation in degrees
[[nodiscard]] Expected<CameraAngles> parseCameraAngles(std::string_view text);

}  // namespace c3de::app
