// SPDX-License-Identifier: Apache-2.0
// All cases of a study in one picture.
#include "drawing.h"

namespace c3de::study {
namespace {

// Layout, in the units of the picture.
constexpr double kPanel = 264, kPanelHeight = 236, kMargin = 12;
constexpr double kPlotLeft = 50, kPlotRight = 254, kPlotTop = 48, kPlotBottom = 192;
constexpr double kHeadline = 34, kRow = 21;
constexpr std::size_t kMaxColumns = 4;

/// One case, small: marks without their labels.
class Panel {
 public:
  Panel(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t c, const std::vector<Curve> &curves)
      : case_(study.cases[c]), outcome_(outcome), of_(outcome.cases[c]), curves_(curves),
        looks_(styleIndices(study, plan, curves)),
        percent_(case_.quantity.kind == Quantity::Kind::surface ? 1.0 : 100.0) {}

  std::string draw() {
    out_ = textAt(kPlotLeft, 18, escaped(case_.name), "font-size=\"13\" font-weight=\"600\"");
    out_ += textAt(kPlotLeft, 32, of_.truth ? "reference: " + escaped(shownKind(of_.truth->kind)) : "no reference",
                   quiet());
    scale();
    frame();
    front();
    for (std::size_t i = 0; i < curves_.size(); ++i)
      out_ += EarlierCurve(outcome_, curves_[i], percent_).draw(x_, y_, colourOf(i));
    for (std::size_t i = 0; i < curves_.size(); ++i) line(i);
    for (std::size_t i = 0; i < curves_.size(); ++i) marks(i);
    failures();
    return out_;
  }

 private:
  static std::string quiet(const std::string &more = "") {
    return fmt::format("font-size=\"9.5\" fill=\"{}\" {}", kQuiet, more);
  }
  [[nodiscard]] bool isDrawn(std::size_t p) const {
    const PointOutcome &point = outcome_.points[p];
    return of_.truth && point.cost && point.errors.quantity && point.failure.empty();
  }
  [[nodiscard]] double xOf(std::size_t p) const { return x_.at(outcome_.points[p].cost->median); }
  [[nodiscard]] double yOf(std::size_t p) const { return y_.at(percent_ * *outcome_.points[p].errors.quantity); }
  [[nodiscard]] std::string colourOf(std::size_t i) const { return kColours[looks_[i] % kColours.size()]; }
  void scale();
  void frame();
  void front();
  void line(std::size_t i);
  void marks(std::size_t i);
  void failures();

  const Case &case_;
  const Outcome &outcome_;
  const CaseOutcome &of_;
  const std::vector<Curve> &curves_;
  std::vector<std::size_t> looks_;
  double percent_;
  Axis x_, y_;
  std::string out_;
};

void Panel::scale() {
  std::vector<double> costs, errors;
  for (const Curve &curve : curves_) {
    for (const std::size_t p : curve.points)
      if (isDrawn(p)) {
        costs.push_back(outcome_.points[p].cost->median);
        errors.push_back(percent_ * *outcome_.points[p].errors.quantity);
      }
    const EarlierCurve before(outcome_, curve, percent_);
    costs.insert(costs.end(), before.costs().begin(), before.costs().end());
    errors.insert(errors.end(), before.errors().begin(), before.errors().end());
  }
  x_.from = kPlotLeft;
  x_.to = kPlotRight;
  y_.from = kPlotBottom;
  y_.to = kPlotTop;
  x_.hold(costs);
  y_.hold(errors);
}

void Panel::frame() {
  const double bar = of_.truth ? y_.at(percent_ * of_.truth->bar) : kPlotBottom;
  if (bar < kPlotBottom)
    out_ += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"{}\" fill-opacity=\"0.6\"/>\n", kPlotLeft,
        std::max(bar, kPlotTop), kPlotRight - kPlotLeft, kPlotBottom - std::max(bar, kPlotTop), kBand);
  // Labels at a minimum distance, since decades may be close together.
  double last = -1e9;
  for (const double tick : x_.ticks()) {
    const double x = x_.at(tick);
    out_ += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" stroke=\"{3}\"/>\n", x, kPlotTop, kPlotBottom, kLine);
    if (x - last < 34.0) continue;
    out_ += textAt(x, kPlotBottom + 14, tickText(tick), quiet("text-anchor=\"middle\""));
    last = x;
  }
  last = 1e9;
  for (const double tick : y_.ticks()) {
    const double y = y_.at(tick);
    out_ += fmt::format("<path d=\"M{1} {0:.1f}H{2}\" stroke=\"{3}\"/>\n", y, kPlotLeft, kPlotRight, kLine);
    if (last - y < 15.0) continue;
    out_ += textAt(kPlotLeft - 6, y + 3.5, tickText(tick), quiet("text-anchor=\"end\""));
    last = y;
  }
  out_ += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" stroke=\"{4}\" fill=\"none\"/>\n", kPlotLeft, kPlotTop, kPlotBottom,
                      kPlotRight, kQuiet);
  out_ += textAt(0.5 * (kPlotLeft + kPlotRight), kPlotBottom + 28,
                 of_.hasTime ? "ms of computing per simulated second" : "ms of computing per solution",
                 quiet("text-anchor=\"middle\""));
  out_ += fmt::format("<text transform=\"translate(11 {:.1f}) rotate(-90)\" {}>error, {}</text>\n",
                      0.5 * (kPlotTop + kPlotBottom), quiet("text-anchor=\"middle\""), percent_ == 1.0 ? "mm" : "%");
}

void Panel::front() {
  std::vector<std::array<double, 2>> points;
  for (const Curve &curve : curves_)
    for (const std::size_t p : curve.points)
      if (isDrawn(p) && outcome_.points[p].isOnFront) points.push_back({xOf(p), yOf(p)});
  out_ += frontPath(std::move(points), kPlotTop, kPlotRight);
}

void Panel::line(std::size_t i) {
  std::string path;
  bool isDown = false;
  for (const std::size_t p : curves_[i].points) {
    const bool isBroken = !isDown;
    isDown = isDrawn(p);
    if (isDown) path += fmt::format("{}{:.1f} {:.1f}", isBroken ? "M" : "L", xOf(p), yOf(p));
  }
  if (!path.empty())
    out_ += fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"1.5\" fill=\"none\"/>\n", path, colourOf(i));
}

void Panel::marks(std::size_t i) {
  for (const std::size_t p : curves_[i].points)
    if (isDrawn(p)) out_ += markAt(looks_[i], xOf(p), yOf(p), colourOf(i), outcome_.points[p].isOnFront);
}

void Panel::failures() {
  double x = kPlotRight - 5;
  for (std::size_t i = 0; i < curves_.size(); ++i)
    for (const std::size_t p : curves_[i].points)
      if (!outcome_.points[p].failure.empty()) {
        out_ += crossAt(x, kPlotTop - 8, colourOf(i));
        x -= 11;
      }
  if (x < kPlotRight - 5) out_ += textAt(x - 2, kPlotTop - 4.5, "failed", quiet("text-anchor=\"end\""));
}

/// Curves that at least two cases have; for a study with one case all.
std::vector<std::vector<Curve>> sharedCurves(const Study &study, const Plan &plan) {
  std::vector<std::vector<Curve>> all;
  std::map<std::string, int> cases;
  for (std::size_t c = 0; c < study.cases.size(); ++c) {
    all.push_back(curvesOf(study, plan, c));
    for (const Curve &curve : all.back()) ++cases[curve.label];
  }
  if (study.cases.size() > 1)
    for (auto &curves : all) std::erase_if(curves, [&](const Curve &curve) { return cases[curve.label] < 2; });
  return all;
}

/// In rows as wide as the picture. @return y at which they end
double addLegend(const Study &study, const Plan &plan, const Outcome &outcome,
                 const std::vector<std::vector<Curve>> &all, double width, double y, std::string &out) {
  const std::string quiet = fmt::format("fill=\"{}\"", kQuiet);
  double x = kMargin + kPlotLeft;
  const auto place = [&](const std::string &text) {
    const double needs = 24 + widthOf(text, 11.5) + 22;
    if (x + needs > width) {
      x = kMargin + kPlotLeft;
      y += kRow;
    }
    const double at = x;
    x += needs;
    return at;
  };
  std::vector<std::string> known;
  for (const auto &curves : all) {
    const std::vector<std::size_t> looks = styleIndices(study, plan, curves);
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (std::find(known.begin(), known.end(), curves[i].label) != known.end()) continue;
      known.push_back(curves[i].label);
      const double at = place(curves[i].label);
      const char *colour = kColours[looks[i] % kColours.size()];
      out += fmt::format("<path d=\"M{:.1f} {:.1f}h16\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", at, y, colour);
      out += markAt(looks[i], at + 8, y, colour, true) + textAt(at + 23, y + 4, escaped(curves[i].label), "");
    }
  }
  y += kRow;
  x = kMargin + kPlotLeft;
  double at = place("on the front");
  out += markAt(0, at + 8, y, kQuiet, true) + textAt(at + 23, y + 4, "on the front", quiet);
  at = place("not on the front");
  out += markAt(0, at + 8, y, kQuiet, false) + textAt(at + 23, y + 4, "not on the front", quiet);
  at = place("uncertainty of the reference");
  out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"16\" height=\"10\" fill=\"{}\"/>\n", at, y - 5, kBand) +
         textAt(at + 23, y + 4, "uncertainty of the reference", quiet);
  if (outcome.earlier) {
    const std::string name = shownName(*outcome.earlier);
    at = place(name);
    out += earlierSample(at, y) + textAt(at + 23, y + 4, escaped(name), quiet);
  }
  return y + kRow;
}

}  // namespace

std::string overviewOf(const Study &study, const Plan &plan, const Outcome &outcome) {
  const auto all = sharedCurves(study, plan);
  // As few rows as possible, with equal numbers: nine cases are three by three.
  const std::size_t rows = (all.size() + kMaxColumns - 1) / kMaxColumns, columns = (all.size() + rows - 1) / rows;
  const double width = 2 * kMargin + kPanel * static_cast<double>(std::max<std::size_t>(columns, 2));
  std::string panels;
  for (std::size_t c = 0; c < all.size(); ++c)
    panels += fmt::format(
        "<g transform=\"translate({} {})\">\n{}</g>\n", kMargin + kPanel * static_cast<double>(c % columns),
        kHeadline + kPanelHeight * static_cast<double>(c / columns), Panel(study, plan, outcome, c, all[c]).draw());
  const double height =
      addLegend(study, plan, outcome, all, width, kHeadline + kPanelHeight * static_cast<double>(rows) + 14, panels);
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
             "role=\"img\" "
             "font-family=\"Inter, 'Source Sans 3', 'Segoe UI', 'Helvetica Neue', 'DejaVu Sans', sans-serif\" "
             "font-size=\"11.5\" fill=\"{2}\">\n<title>{3}</title>\n<rect width=\"{0}\" height=\"{1}\" "
             "fill=\"#fff\"/>\n",
             width, height, kInk, escaped(study.title)) +
         textAt(kMargin + kPlotLeft, 26, escaped(study.title), "font-size=\"16\" font-weight=\"600\"") + panels +
         "</svg>\n";
}

}  // namespace c3de::study
