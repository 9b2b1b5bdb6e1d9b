// SPDX-License-Identifier: Apache-2.0
#include "fields/colour_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pointbased {
namespace {

using Triple = std::array<double, 3>;

constexpr double kRadians = 3.14159265358979323846 / 180.0;

/// L, a, b of the curve at t in 0 … 1.
Triple curve(double t) {
  const double lightness = 0.30 + 0.62 * t, hue = kRadians * (305.0 - 200.0 * t);
  const double chroma = 0.10 + 0.05 * (2.0 * t - 1.0) * (2.0 * t - 1.0);
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

double cube(double x) { return x * x * x; }

std::uint8_t encoded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double srgb = c < 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb));
}

Rgba8 srgbOf(const Triple &lab) {
  const auto [L, a, b] = lab;
  const double l = cube(L + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(L - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(L - 0.0894841775 * a - 1.2914855480 * b);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 255};
}

std::array<Rgba8, kColours> makeMap() {
  constexpr std::size_t kPieces = 2048;
  std::vector<double> length{0.0};
  Triple before = curve(0.0);
  for (std::size_t i = 1; i <= kPieces; ++i) {
    const Triple next = curve(static_cast<double>(i) / kPieces);
    length.push_back(length.back() + std::hypot(next[0] - before[0], next[1] - before[1], next[2] - before[2]));
    before = next;
  }
  std::array<Rgba8, kColours> map;
  for (std::size_t k = 0; k < kColours; ++k) {
    const double wanted = length.back() * static_cast<double>(k) / (kColours - 1);
    const auto found = std::lower_bound(length.begin(), length.end(), wanted);
    map[k] = srgbOf(curve(static_cast<double>(std::min<std::ptrdiff_t>(found - length.begin(), kPieces)) / kPieces));
  }
  return map;
}

}  // namespace

const std::array<Rgba8, kColours> &colourMap() {
  static const std::array<Rgba8, kColours> map = makeMap();
  return map;
}

Rgba8 colourOf(double value, double low, double high) {
  const double t = (value - low) / (high - low);
  if (!(t < 1.0)) return colourMap().back();
  return colourMap()[static_cast<std::size_t>(std::lround(std::max(t, 0.0) * (kColours - 1)))];
}

}  // namespace pointbased
