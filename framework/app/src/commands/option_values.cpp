// SPDX-License-Identifier: Apache-2.0
#include "commands/option_values.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "c3de/core/text.h"

namespace c3de::app {
namespace {

/// The whole text must be a number, which may begin with one '+'.
template <class T>
std::optional<T> parsed(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

tl::unexpected<Error> refuse(std::string_view text, const std::string &accepted) {
  return fail(ErrorCode::usage, "'" + std::string(text) + "' is not accepted; accepted: " + accepted);
}

}  // namespace

Expected<double> parseDecimal(std::string_view text, double least, double most, std::string_view unit) {
  const auto value = parsed<double>(text);
  // Written so that NaN is refused.
  if (value && *value >= least && *value <= most) return *value;
  return refuse(text, "a number from " + formatNumber(least) + " to " + formatNumber(most) +
                          (unit.empty() ? "" : " " + std::string(unit)) + ", with a decimal point");
}

Expected<long long> parseWhole(std::string_view text, long long least, long long most) {
  const auto value = parsed<long long>(text);
  if (value && *value >= least && *value <= most) return *value;
  return refuse(text, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

Expected<PictureSize> parseSize(std::string_view text) {
  const std::size_t x = text.find('x');
  if (x != std::string_view::npos) {
    const auto width = parsed<int>(text.substr(0, x)), height = parsed<int>(text.substr(x + 1));
    const auto fits = [](const std::optional<int> &pixels) { return pixels && *pixels >= 16 && *pixels <= 16384; };
    if (fits(width) && fits(height)) return PictureSize{*width, *height};
  }
  return refuse(text, "WIDTHxHEIGHT in pixels, 16 to 16384, for example 1280x720");
}

Expected<CameraAngles> parseCameraAngles(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma != std::string_view::npos) {
    const auto azimuth = parsed<double>(text.substr(0, comma)), elevation = parsed<double>(text.substr(comma + 1));
    if (azimuth && elevation && std::abs(*azimuth) <= 360.0 && std::abs(*elevation) <= 90.0)
      return CameraAngles{*azimuth, *elevation};
  }
  return refuse(text, "AZIMUTH,ELEVATION in degrees, -360 to 360 and -90 to 90, for example 30,20");
}

}  // namespace c3de::app
