// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "c3de/study/report.h"

namespace c3de::study {
namespace {

// Layout, in the units of the picture.
constexpr double kWidth = 760, kHeight = 470;
constexpr double kLeft = 74, kRight = 556, kTop = 86, kBottom = 402;
constexpr double kLegendLeft = 580, kRow = 19;
constexpr double kTitle = 54;  // height of the title
constexpr double kMark = 4.4;
constexpr double kLabelSize = 10.5;
constexpr double kRealTime_ms = 1000.0;

// Colours that people with and without full colour vision tell apart, and that print; shapes tell curves apart as well.
// Okabe and Ito, Color Universal Design (2008), without the yellow, which does not show on white.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#aa4499", "#b8860b", "#4c9fcf", "#333333"};
constexpr const char *kInk = "#1c2733", *kQuiet = "#5d6b79", *kLine = "#e3e7eb", *kBand = "#d9dee4";

/// Logarithmic.
struct Axis {
  double low = 1.0, high = 10.0;  ///< in decades
  double from = 0.0, to = 1.0;    ///< on the picture

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
    // At least one round number has to be in it, or nobody can read it.
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

/// 0.001 … 9999 as they are, else powers of ten.
std::string tickText(double value) {
  if (value >= 0.999e-3 && value < 1e5) return fmt::format("{:.4g}", value);
  const int decade = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  const double step = value / std::pow(10.0, decade);
  const std::string power = fmt::format("10<tspan dy=\"-4\" font-size=\"8\">{}</tspan>", decade);
  return step < 1.05 ? power : fmt::format("{:.2g}·", step) + power;
}

struct Rectangle {
  double left, top, right, bottom;
  [[nodiscard]] double overlap(const Rectangle &o) const {
    const double w = std::min(right, o.right) - std::max(left, o.left),
                 h = std::min(bottom, o.bottom) - std::max(top, o.top);
    return w > 0.0 && h > 0.0 ? w * h : 0.0;
  }
};

/// About how wide a text is, of a common sans serif.
double widthOf(const std::string &text, double size) {
  double letters = 0.0;
  for (const char c : text)
    if ((static_cast<unsigned char>(c) & 0xc0) != 0x80)
      letters += c == ' ' || c == '.' || c == ',' || c == 'i' || c == 'l' ? 0.33 : c == 'm' || c == 'w' ? 0.86 : 0.57;
  return letters * size;
}

std::string textAt(double x, double y, const std::string &text, const std::string &style) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, text);
}

/// A circle, square, triangle or diamond; filled: on the front.
std::string markAt(std::size_t shape, double x, double y, const std::string &colour, bool isFilled) {
  const std::string look =
      fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.6\"", isFilled ? colour : "#fff", colour);
  const double r = kMark;
  switch (shape % 4) {
    case 0: return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>\n", x, y, r, look);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>\n", x - 0.9 * r,
                         y - 0.9 * r, 1.8 * r, 1.8 * r, look);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n", x, y - 1.15 * r, x + 1.1 * r,
                         y + 0.85 * r, x - 1.1 * r, y + 0.85 * r, look);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n", x, y - 1.3 * r,
                         x + 1.2 * r, y, x, y + 1.3 * r, x - 1.2 * r, y, look);
  }
}

std::string crossAt(double x, double y, const std::string &colour) {
  return fmt::format(
      "<path d=\"M{0:.1f} {2:.1f}L{1:.1f} {3:.1f}M{0:.1f} {3:.1f}L{1:.1f} {2:.1f}\" stroke=\"{4}\" "
      "stroke-width=\"1.8\" fill=\"none\"/>\n",
      x - 4.0, x + 4.0, y - 4.0, y + 4.0, colour);
}

/// One work-precision diagram.
class Diagram {
 public:
  Diagram(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t c, bool hasTitle)
      : study_(study), plan_(plan), outcome_(outcome), case_(study.cases[c]), of_(outcome.cases[c]),
        curves_(curvesOf(study, plan, c)), common_(commonLever(study, c)), hasTitle_(hasTitle) {
    percent_ = case_.quantity.kind == Quantity::Kind::surface ? 1.0 : 100.0;
  }

  std::string draw() {
    head();
    scale();
    frame();
    band();
    front();
    for (std::size_t i = 0; i < curves_.size(); ++i) curve(i);
    for (std::size_t i = 0; i < curves_.size(); ++i) marks(i);
    for (std::size_t i = 0; i < curves_.size(); ++i) labels(i);
    failures();
    legend();
    return out_ + "</svg>\n";
  }

 private:
  void head();
  void scale();
  void frame();
  void band();
  void front();
  void curve(std::size_t i);
  void marks(std::size_t i);
  void labels(std::size_t i);
  void failures();
  void legend();

  [[nodiscard]] bool isDrawn(std::size_t p) const {
    const PointOutcome &point = outcome_.points[p];
    return of_.truth && point.cost && point.errors.quantity && point.failure.empty();
  }
  [[nodiscard]] double xOf(std::size_t p) const { return x_.at(outcome_.points[p].cost->median); }
  /// What agrees with the reference to the last digit lies at the lower edge.
  [[nodiscard]] double yOf(std::size_t p) const { return y_.at(percent_ * *outcome_.points[p].errors.quantity); }
  [[nodiscard]] std::string labelOf(std::size_t p) const {
    std::string text = pointLabel(study_, plan_.points[p]);
    return !common_.empty() && text.starts_with(common_ + " ") ? text.substr(common_.size() + 1) : text;
  }
  /// Keeps labels off a line.
  void take(double fromX, double fromY, double toX, double toY) {
    const double length = std::hypot(toX - fromX, toY - fromY);
    const int steps = std::max(1, static_cast<int>(length / 4.0));
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps, x = fromX + t * (toX - fromX), y = fromY + t * (toY - fromY);
      taken_.push_back({x - 2, y - 2, x + 2, y + 2});
    }
  }
  [[nodiscard]] std::string colourOf(std::size_t i) const { return kColours[i % kColours.size()]; }

  const Study &study_;
  const Plan &plan_;
  const Outcome &outcome_;
  const Case &case_;
  const CaseOutcome &of_;
  std::vector<Curve> curves_;
  std::string common_;  ///< what all labels begin with
  bool hasTitle_;
  double percent_ = 100.0;
  Axis x_, y_;
  bool showsBand_ = false, isAnyDrawn_ = false;
  std::vector<Rectangle> taken_;
  std::string out_;
};

void Diagram::head() {
  out_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 {4} {0} {5}\" width=\"{0}\" height=\"{5}\" role=\"img\" "
      "font-family=\"Inter, 'Source Sans 3', 'Segoe UI', 'Helvetica Neue', 'DejaVu Sans', sans-serif\" "
      "font-size=\"11.5\" "
      "fill=\"{2}\">\n<title>{3}: error against cost</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kWidth, kHeight, kInk, escaped(case_.name), hasTitle_ ? 0.0 : kTitle, hasTitle_ ? kHeight : kHeight - kTitle);
  if (!hasTitle_) return;
  out_ += textAt(kLeft, 26, escaped(case_.name), "font-size=\"16\" font-weight=\"600\"");
  out_ += textAt(kLeft, 45, escaped(case_.quantity.shown()), fmt::format("fill=\"{}\"", kQuiet));
}

void Diagram::scale() {
  std::vector<double> costs, errors;
  for (const Curve &curve : curves_)
    for (const std::size_t p : curve.points)
      if (isDrawn(p)) {
        costs.insert(costs.end(), {outcome_.points[p].cost->cheapest, outcome_.points[p].cost->dearest});
        errors.push_back(percent_ * *outcome_.points[p].errors.quantity);
      }
  const double bar = of_.truth ? percent_ * of_.truth->bar : 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double error : errors)
    if (error > 0.0) least = std::min(least, error);
  // A band far below all errors would only push them together.
  isAnyDrawn_ = !errors.empty();
  showsBand_ = bar > 0.0 && !errors.empty() && bar > 0.02 * least;
  if (showsBand_) errors.push_back(bar);
  x_.from = kLeft;
  x_.to = kRight;
  y_.from = kBottom;
  y_.to = kTop;
  x_.hold(costs);
  y_.hold(errors);
}

void Diagram::frame() {
  for (const double tick : isAnyDrawn_ ? x_.ticks() : std::vector<double>{}) {
    const double x = x_.at(tick);
    out_ += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" stroke=\"{3}\"/>\n", x, kTop, kBottom, kLine);
    out_ += textAt(x, kBottom + 18, tickText(tick), fmt::format("text-anchor=\"middle\" fill=\"{}\"", kQuiet));
  }
  for (const double tick : isAnyDrawn_ ? y_.ticks() : std::vector<double>{}) {
    const double y = y_.at(tick);
    out_ += fmt::format("<path d=\"M{1} {0:.1f}H{2}\" stroke=\"{3}\"/>\n", y, kLeft, kRight, kLine);
    out_ += textAt(kLeft - 9, y + 4, tickText(tick), fmt::format("text-anchor=\"end\" fill=\"{}\"", kQuiet));
  }
  if (isAnyDrawn_ && of_.hasTime && x_.at(kRealTime_ms) > kLeft && x_.at(kRealTime_ms) < kRight) {
    const double x = x_.at(kRealTime_ms);
    const bool isLeft = x > kRight - 60;
    out_ += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" stroke=\"{3}\" stroke-dasharray=\"2 3\"/>\n", x, kTop, kBottom,
                        kQuiet);
    out_ += textAt(isLeft ? x - 5 : x + 5, kTop + 13, "real time",
                   fmt::format("text-anchor=\"{}\" font-size=\"10\" fill=\"{}\"", isLeft ? "end" : "start", kQuiet));
    taken_.push_back({isLeft ? x - 52 : x + 3, kTop + 3, isLeft ? x - 3 : x + 52, kTop + 16});
  }
  out_ += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" stroke=\"{4}\" fill=\"none\"/>\n", kLeft, kTop, kBottom, kRight,
                      kQuiet);
  out_ += textAt(0.5 * (kLeft + kRight), kBottom + 42,
                 !isAnyDrawn_  ? "cost"
                 : of_.hasTime ? "cost: ms of computing per simulated second"
                               : "cost: ms of computing per solution",
                 "text-anchor=\"middle\"");
  out_ += fmt::format("<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\">error{}</text>\n",
                      0.5 * (kTop + kBottom), percent_ == 1.0 ? ": largest difference, mm" : ", %");
}

void Diagram::band() {
  if (!showsBand_) return;
  const double y = y_.at(percent_ * of_.truth->bar);
  out_ += fmt::format(
      "<rect x=\"{0}\" y=\"{1:.1f}\" width=\"{2}\" height=\"{3:.1f}\" fill=\"{4}\" fill-opacity=\"0.6\"/>\n", kLeft, y,
      kRight - kLeft, kBottom - y, kBand);
  if (kBottom - y < 15.0) return;
  out_ += textAt(kRight - 6, kBottom - 6, "uncertainty of the reference",
                 fmt::format("text-anchor=\"end\" font-size=\"10\" fill=\"{}\"", kQuiet));
  taken_.push_back({kRight - 150, kBottom - 17, kRight, kBottom});
}

/// Steps: what the least error is that one gets for a cost.
void Diagram::front() {
  std::vector<std::size_t> points;
  for (const Curve &curve : curves_)
    for (const std::size_t p : curve.points)
      if (isDrawn(p) && outcome_.points[p].isOnFront) points.push_back(p);
  std::sort(points.begin(), points.end(), [this](std::size_t a, std::size_t b) { return xOf(a) < xOf(b); });
  if (points.empty()) return;
  double y = yOf(points.front());
  std::string path = fmt::format("M{:.1f} {}V{:.1f}", xOf(points.front()), kTop, y);
  for (const std::size_t p : points) {
    if (yOf(p) <= y) continue;
    path += fmt::format("H{:.1f}V{:.1f}", xOf(p), yOf(p));
    y = yOf(p);
  }
  out_ +=
      fmt::format("<path d=\"{}H{}\" stroke=\"#c3ccd5\" stroke-width=\"5\" stroke-linejoin=\"round\" fill=\"none\"/>\n",
                  path, kRight);
}

void Diagram::curve(std::size_t i) {
  std::string path;
  bool isDown = false;
  double fromX = 0.0, fromY = 0.0;
  for (const std::size_t p : curves_[i].points) {
    // What failed lies between its neighbours.
    const bool isBroken = !isDown;
    isDown = isDrawn(p);
    if (!isDown) continue;
    path += fmt::format("{}{:.1f} {:.1f}", isBroken ? "M" : "L", xOf(p), yOf(p));
    if (!isBroken) take(fromX, fromY, xOf(p), yOf(p));
    fromX = xOf(p);
    fromY = yOf(p);
  }
  if (!path.empty())
    out_ += fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"1.5\" fill=\"none\"/>\n", path, colourOf(i));
}

void Diagram::marks(std::size_t i) {
  for (const std::size_t p : curves_[i].points) {
    if (!isDrawn(p)) continue;
    const Cost &cost = *outcome_.points[p].cost;
    const double x = xOf(p), y = yOf(p);
    out_ += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"{}\" stroke-width=\"1.2\"/>\n",
                        x_.at(cost.cheapest), y, x_.at(cost.dearest), colourOf(i));
    take(x_.at(cost.cheapest), y, x_.at(cost.dearest), y);
    out_ += markAt(i, x, y, colourOf(i), outcome_.points[p].isOnFront);
    taken_.push_back({x - 6, y - 6, x + 6, y + 6});
  }
}

void Diagram::labels(std::size_t i) {
  for (const std::size_t p : curves_[i].points) {
    if (!isDrawn(p)) continue;
    const std::string text = labelOf(p);
    const double w = widthOf(text, kLabelSize), x = xOf(p), y = yOf(p);
    // Beside, above and below the mark: the place where it covers least.
    const std::array<std::array<double, 2>, 8> places{{{x + 8, y - 6},
                                                       {x + 8, y + 12},
                                                       {x - 8 - w, y - 6},
                                                       {x - 8 - w, y + 12},
                                                       {x - 0.5 * w, y - 9},
                                                       {x - 0.5 * w, y + 17},
                                                       {x + 10, y + 3.5},
                                                       {x - 10 - w, y + 3.5}}};
    double least = std::numeric_limits<double>::infinity();
    Rectangle best{};
    for (const auto &[left, base] : places) {
      const Rectangle box{left, base - 9, left + w, base + 2};
      double cost = 0.0;
      for (const Rectangle &other : taken_) cost += box.overlap(other);
      cost += 1e3 * (std::max(0.0, kLeft + 2 - box.left) + std::max(0.0, box.right - kRight - 4) +
                     std::max(0.0, kTop - box.top) + std::max(0.0, box.bottom - kBottom));
      if (cost < least - 1e-9) {
        least = cost;
        best = box;
      }
    }
    taken_.push_back(best);
    // Twice, first as a halo: not every program that shows pictures knows paint-order.
    const std::string look = fmt::format("font-size=\"{}\" ", kLabelSize);
    out_ += textAt(best.left, best.bottom - 2, escaped(text),
                   look + "stroke=\"#fff\" stroke-width=\"2.4\" stroke-linejoin=\"round\" fill=\"#fff\"");
    out_ += textAt(best.left, best.bottom - 2, escaped(text), look + fmt::format("fill=\"{}\"", colourOf(i)));
  }
}

void Diagram::failures() {
  std::vector<std::pair<std::size_t, std::size_t>> failed;  // curve, point
  for (std::size_t i = 0; i < curves_.size(); ++i)
    for (const std::size_t p : curves_[i].points)
      if (!outcome_.points[p].failure.empty()) failed.emplace_back(i, p);
  if (failed.empty()) return;
  const double y = kTop - 18;
  out_ += textAt(kLeft, y + 4, "failed", fmt::format("font-size=\"10\" fill=\"{}\"", kQuiet));
  const double begin = kLeft + 44, step = (kRight - begin) / static_cast<double>(failed.size());
  for (std::size_t n = 0; n < failed.size(); ++n) {
    const auto &[i, p] = failed[n];
    const double x = begin + 8 + static_cast<double>(n) * step;
    out_ += crossAt(x, y, colourOf(i));
    // Where the words have no room the table has them.
    const std::string label = labelOf(p), all = label + ": " + outcome_.points[p].failure;
    const auto fits = [&](const std::string &text) { return widthOf(text, 10.0) < step - 16; };
    if (fits(label))
      out_ += textAt(x + 8, y + 3.5, escaped(fits(all) ? all : label),
                     fmt::format("font-size=\"10\" fill=\"{}\"", colourOf(i)));
  }
}

void Diagram::legend() {
  double y = kTop + 4;
  const double room = kWidth - kLegendLeft - 24;
  for (std::size_t i = 0; i < curves_.size(); ++i, y += kRow) {
    out_ +=
        fmt::format("<path d=\"M{} {:.1f}h16\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", kLegendLeft, y, colourOf(i));
    out_ += markAt(i, kLegendLeft + 8, y, colourOf(i), true);
    std::string text = curves_[i].label;
    if (widthOf(text, 11.5) > room)
      while (!text.empty() && widthOf(text + "…", 11.5) > room) {
        do text.pop_back();
        while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xc0) == 0x80);
      }
    out_ += textAt(kLegendLeft + 23, y + 4, escaped(text) + (text.size() < curves_[i].label.size() ? "…" : ""), "");
  }
  y += 8;
  const std::string quiet = fmt::format("font-size=\"10.5\" fill=\"{}\"", kQuiet);
  out_ += markAt(0, kLegendLeft + 8, y, kQuiet, true) + textAt(kLegendLeft + 23, y + 4, "on the front", quiet);
  y += kRow - 2;
  out_ += markAt(0, kLegendLeft + 8, y, kQuiet, false) + textAt(kLegendLeft + 23, y + 4, "another is better", quiet);
  y += kRow - 2;
  out_ += fmt::format("<path d=\"M{} {:.1f}h16\" stroke=\"{}\" stroke-width=\"1.2\"/>\n", kLegendLeft, y, kQuiet) +
          textAt(kLegendLeft + 23, y + 4, "range of the repeats", quiet);
  if (!common_.empty()) {
    y += kRow - 2;
    out_ += textAt(kLegendLeft + 8, y + 4, "8", quiet + " text-anchor=\"middle\"") +
            textAt(kLegendLeft + 23, y + 4, escaped(common_), quiet);
  }
  y += kRow + 8;
  if (!isAnyDrawn_)
    out_ += textAt(0.5 * (kLeft + kRight), 0.5 * (kTop + kBottom),
                   of_.truth ? "no run came to its end" : "no reference to compare with", "text-anchor=\"middle\"");
  if (!of_.truth) return;
  out_ +=
      textAt(kLegendLeft, y, "reference", quiet) + textAt(kLegendLeft, y + 16, escaped(shownKind(of_.truth->kind)), "");
  y += 33;
  if (of_.truth->order && std::isfinite(*of_.truth->order)) {
    out_ += textAt(kLegendLeft, y, "observed order " + threeDigits(*of_.truth->order), quiet);
    y += 16;
  }
  out_ += textAt(kLegendLeft, y,
                 "uncertainty " + threeDigits(percent_ * of_.truth->bar) + (percent_ == 1.0 ? " mm" : " %") +
                     (showsBand_ || !isAnyDrawn_ || of_.truth->bar == 0.0 ? "" : ", below"),
                 quiet);
}

}  // namespace

std::string diagramOf(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t ofCase, bool hasTitle) {
  return Diagram(study, plan, outcome, ofCase, hasTitle).draw();
}

}  // namespace c3de::study
