// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drawing.h"

namespace c3de::study {
namespace {

// Layout, in the units of the picture.
constexpr double kWidth = 760, kHeight = 470;
constexpr double kLeft = 74, kRight = 556, kTop = 86, kBottom = 402;
constexpr double kLegendLeft = 580, kRow = 19;
constexpr double kTitle = 54;  // height of the title
constexpr double kLabelSize = 10.5;
constexpr double kRealTime_ms = 1000.0;

/// One work-precision diagram.
class Diagram {
 public:
  Diagram(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t c, bool hasTitle)
      : study_(study), plan_(plan), outcome_(outcome), case_(study.cases[c]), of_(outcome.cases[c]),
        curves_(curvesOf(study, plan, c)), looks_(styleIndices(study, plan, curves_)),
        common_(commonParameter(study, c)), hasTitle_(hasTitle) {
    percent_ = case_.quantity.kind == Quantity::Kind::surface ? 1.0 : 100.0;
  }

  std::string draw() {
    head();
    scale();
    frame();
    band();
    front();
    for (std::size_t i = 0; i < curves_.size(); ++i)
      out_ += EarlierCurve(outcome_, curves_[i], percent_).draw(x_, y_, colourOf(i));
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
  /// A point that agrees with the reference to the last digit is at the lower edge.
  [[nodiscard]] double yOf(std::size_t p) const { return y_.at(percent_ * *outcome_.points[p].errors.quantity); }
  [[nodiscard]] std::string labelOf(std::size_t p) const {
    std::string text = pointLabel(study_, plan_.points[p]);
    return !common_.empty() && text.starts_with(common_ + " ") ? text.substr(common_.size() + 1) : text;
  }
  /// Reserves the space along a line, so that no labels are placed there.
  void take(double fromX, double fromY, double toX, double toY) {
    const double length = std::hypot(toX - fromX, toY - fromY);
    const int steps = std::max(1, static_cast<int>(length / 4.0));
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps, x = fromX + t * (toX - fromX), y = fromY + t * (toY - fromY);
      taken_.push_back({x - 2, y - 2, x + 2, y + 2});
    }
  }
  [[nodiscard]] std::string colourOf(std::size_t i) const { return kColours[looks_[i] % kColours.size()]; }

  const Study &study_;
  const Plan &plan_;
  const Outcome &outcome_;
  const Case &case_;
  const CaseOutcome &of_;
  std::vector<Curve> curves_;
  std::vector<std::size_t> looks_;  ///< of the curves: colour and shape
  std::string common_;              ///< common beginning of all labels
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
  for (const Curve &curve : curves_) {
    for (const std::size_t p : curve.points)
      if (isDrawn(p)) {
        costs.insert(costs.end(), {outcome_.points[p].cost->cheapest, outcome_.points[p].cost->dearest});
        errors.push_back(percent_ * *outcome_.points[p].errors.quantity);
      }
    if (!of_.truth) continue;
    const EarlierCurve before(outcome_, curve, percent_);
    costs.insert(costs.end(), before.costs().begin(), before.costs().end());
    errors.insert(errors.end(), before.errors().begin(), before.errors().end());
  }
  const double bar = of_.truth ? percent_ * of_.truth->bar : 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double error : errors)
    if (error > 0.0) least = std::min(least, error);
  // A band far below all errors would only compress their range.
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

void Diagram::front() {
  std::vector<std::array<double, 2>> points;
  for (const Curve &curve : curves_)
    for (const std::size_t p : curve.points)
      if (isDrawn(p) && outcome_.points[p].isOnFront) points.push_back({xOf(p), yOf(p)});
  out_ += frontPath(std::move(points), kTop, kRight);
}

void Diagram::curve(std::size_t i) {
  std::string path;
  bool isDown = false;
  double fromX = 0.0, fromY = 0.0;
  for (const std::size_t p : curves_[i].points) {
    // A failed point interrupts the line.
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
    out_ += markAt(looks_[i], x, y, colourOf(i), outcome_.points[p].isOnFront);
    taken_.push_back({x - 6, y - 6, x + 6, y + 6});
  }
}

void Diagram::labels(std::size_t i) {
  for (const std::size_t p : curves_[i].points) {
    if (!isDrawn(p)) continue;
    const std::string text = labelOf(p);
    const double w = widthOf(text, kLabelSize), x = xOf(p), y = yOf(p);
    // Next to, above and below the mark: the position that covers least.
    std::vector<std::array<double, 2>> places;
    for (const double far : {0.0, 11.0, 22.0})
      for (const std::array<double, 2> &place :
           {std::array{x + 8, y - 6 - far}, std::array{x + 8, y + 12 + far}, std::array{x - 8 - w, y - 6 - far},
            std::array{x - 8 - w, y + 12 + far}, std::array{x - 0.5 * w, y - 9 - far},
            std::array{x - 0.5 * w, y + 17 + far}, std::array{x + 10 + far, y + 3.5},
            std::array{x - 10 - w - far, y + 3.5}})
        places.push_back(place);
    double least = std::numeric_limits<double>::infinity();
    Rectangle best{};
    for (std::size_t n = 0; n < places.size(); ++n) {
      const auto &[left, base] = places[n];
      const Rectangle box{left, base - 9, left + w, base + 2};
      double cost = 12.0 * static_cast<double>(n / 8);  // near positions are preferred
      for (const Rectangle &other : taken_) cost += box.overlap(other);
      cost += 1e3 * (std::max(0.0, kLeft + 2 - box.left) + std::max(0.0, box.right - kRight - 4) +
                     std::max(0.0, kTop - box.top) + std::max(0.0, box.bottom - kBottom));
      if (cost < least - 1e-9) {
        least = cost;
        best = box;
      }
    }
    taken_.push_back(best);
    // Drawn twice, first as a halo, because not every viewer supports paint-order.
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
    // If there is no space for the words, they are in the table.
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
    out_ += markAt(looks_[i], kLegendLeft + 8, y, colourOf(i), true);
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
  out_ += markAt(0, kLegendLeft + 8, y, kQuiet, false) + textAt(kLegendLeft + 23, y + 4, "not on the front", quiet);
  y += kRow - 2;
  out_ += fmt::format("<path d=\"M{} {:.1f}h16\" stroke=\"{}\" stroke-width=\"1.2\"/>\n", kLegendLeft, y, kQuiet) +
          textAt(kLegendLeft + 23, y + 4, "range of the repeats", quiet);
  if (outcome_.earlier) {
    y += kRow - 2;
    out_ +=
        earlierSample(kLegendLeft, y) + textAt(kLegendLeft + 23, y + 4, escaped(shownName(*outcome_.earlier)), quiet);
  }
  if (!common_.empty()) {
    y += kRow - 2;
    out_ += textAt(kLegendLeft + 8, y + 4, "8", quiet + " text-anchor=\"middle\"") +
            textAt(kLegendLeft + 23, y + 4, escaped(common_), quiet);
  }
  y += kRow + 8;
  if (!isAnyDrawn_)
    out_ += textAt(0.5 * (kLeft + kRight), 0.5 * (kTop + kBottom),
                   of_.truth ? "no run completed" : "no reference to compare with", "text-anchor=\"middle\"");
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
