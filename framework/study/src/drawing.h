// SPDX-License-Identifier: Apache-2.0
// Drawing functions for the pictures of a study.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "c3de/study/report.h"

namespace c3de::study {

// Colours that can be distinguished with and without full colour vision, and in print; curves also differ in shape.
// Okabe and Ito, Color Universal Design (2008), without the yellow, which is not visible on white.
inline constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#aa4499", "#b8860b", "#4c9fcf", "#333333"};
inline constexpr const char *kInk = "#1c2733", *kQuiet = "#5d6b79", *kLine = "#e3e7eb", *kBand = "#d9dee4";

/// Logarithmic axis.
struct Axis {
  double low = 1.0, high = 10.0;  ///< in decades
  double from = 0.0, to = 1.0;    ///< range in the picture

  void hold(const std::vector<double> &values) {
    low = std::numeric_limits<double>::infinity();
    high = -low;
    for (const double value : values)
      if (value > 0.0 && std::isfinite(value)) {
        low = std::min(low, std::log10(value));
        high = std::max(high, std::log10(value));
      }
    if (!(low <= high)) {
      low = 0.0;
      high = 1.0;
    }
    const double margin = std::max(0.08 * (high - low), 0.12);
    low -= margin;
    high += margin;
    // The range must contain at least one round number; otherwise the axis is unreadable.
    if (high - low < 0.5) {
      const double middle = 0.5 * (low + high);
      low = middle - 0.25;
      high = middle + 0.25;
    }
  }
  [[nodiscard]] double at(double value) const {
    if (!(value > 0.0)) return from;
    return from + (to - from) * (std::log10(value) - low) / (high - low);
  }
  [[nodiscard]] std::vector<double> ticks() const {
    const std::vector<double> steps = high - low > 4.0    ? std::vector<double>{1.0}
                                      : high - low > 1.6  ? std::vector<double>{1.0, 3.0}
                                      : high - low > 0.65 ? std::vector<double>{1.0, 2.0, 5.0}
                                                          : std::vector<double>{1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0};
    std::vector<double> out;
    for (int decade = static_cast<int>(std::floor(low)); decade <= static_cast<int>(std::ceil(high)); ++decade)
      for (const double step : steps) {
        const double value = step * std::pow(10.0, decade);
        if (std::log10(value) >= low && std::log10(value) <= high) out.push_back(value);
      }
    return out;
  }
};

struct Rectangle {
  double left, top, right, bottom;
  [[nodiscard]] double overlap(const Rectangle &o) const {
    const double w = std::min(right, o.right) - std::max(left, o.left),
                 h = std::min(bottom, o.bottom) - std::max(top, o.top);
    return w > 0.0 && h > 0.0 ? w * h : 0.0;
  }
};

/// 0.001 … 9999 unchanged, otherwise powers of ten.
[[nodiscard]] std::string tickText(double value);
/// Approximate width of a text in a common sans serif font.
[[nodiscard]] double widthOf(const std::string &text, double size);
[[nodiscard]] std::string textAt(double x, double y, const std::string &text, const std::string &style);
/// A circle, square, triangle, diamond, inverted triangle or pentagon; filled if on the front.
[[nodiscard]] std::string markAt(std::size_t shape, double x, double y, const std::string &colour, bool isFilled);
[[nodiscard]] std::string crossAt(double x, double y, const std::string &colour);

/// Steps through points of the front, from the top at the first to the right of the last: the smallest error available
/// for a cost.
[[nodiscard]] std::string frontPath(std::vector<std::array<double, 2>> points, double top, double right);

/// The points of a curve in an earlier run: small, joined by dashes.
class EarlierCurve {
 public:
  EarlierCurve(const Outcome &outcome, const Curve &curve, double percent);
  [[nodiscard]] const std::vector<double> &costs() const { return costs_; }
  [[nodiscard]] const std::vector<double> &errors() const { return errors_; }
  [[nodiscard]] std::string draw(const Axis &x, const Axis &y, const std::string &colour) const;

 private:
  std::vector<double> costs_, errors_;
};
/// A sample of its line, 16 wide.
[[nodiscard]] std::string earlierSample(double x, double y);
/// "before: 0.9.0, 2026-11-24"
[[nodiscard]] std::string shownName(const EarlierRun &run);

/// For each curve the index of its label among those of the whole study, so that one class of points looks the same in
/// all cases.
[[nodiscard]] std::vector<std::size_t> styleIndices(const Study &study, const Plan &plan,
                                                    const std::vector<Curve> &curves);

}  // namespace c3de::study
