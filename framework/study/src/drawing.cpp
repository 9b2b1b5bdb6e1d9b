// SPDX-License-Identifier: Apache-2.0
#include "drawing.h"

namespace c3de::study {
namespace {

constexpr double kMark = 4.4;

}  // namespace

std::string tickText(double value) {
  if (value >= 0.999e-3 && value < 1e5) return fmt::format("{:.5g}", value);
  const int decade = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  const double step = value / std::pow(10.0, decade);
  const std::string power = fmt::format("10<tspan dy=\"-4\" font-size=\"8\">{}</tspan>", decade);
  return step < 1.05 ? power : fmt::format("{:.2g}·", step) + power;
}

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

std::string markAt(std::size_t shape, double x, double y, const std::string &colour, bool isFilled) {
  const std::string look =
      fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.6\"", isFilled ? colour : "#fff", colour);
  const double r = kMark;
  switch (shape % 6) {
    case 0: return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>\n", x, y, r, look);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>\n", x - 0.9 * r,
                         y - 0.9 * r, 1.8 * r, 1.8 * r, look);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n", x, y - 1.15 * r, x + 1.1 * r,
                         y + 0.85 * r, x - 1.1 * r, y + 0.85 * r, look);
    case 3:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n", x, y - 1.3 * r,
                         x + 1.2 * r, y, x, y + 1.3 * r, x - 1.2 * r, y, look);
    case 4:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n", x, y + 1.15 * r, x + 1.1 * r,
                         y - 0.85 * r, x - 1.1 * r, y - 0.85 * r, look);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" {}/>\n",
                         x, y - 1.15 * r, x + 1.1 * r, y - 0.35 * r, x + 0.7 * r, y + 0.95 * r, x - 0.7 * r,
                         y + 0.95 * r, x - 1.1 * r, y - 0.35 * r, look);
  }
}

std::string crossAt(double x, double y, const std::string &colour) {
  return fmt::format(
      "<path d=\"M{0:.1f} {2:.1f}L{1:.1f} {3:.1f}M{0:.1f} {3:.1f}L{1:.1f} {2:.1f}\" stroke=\"{4}\" "
      "stroke-width=\"1.8\" fill=\"none\"/>\n",
      x - 4.0, x + 4.0, y - 4.0, y + 4.0, colour);
}

std::string frontPath(std::vector<std::array<double, 2>> points, double top, double right) {
  std::sort(points.begin(), points.end());
  if (points.empty()) return {};
  double y = points.front()[1];
  std::string path = fmt::format("M{:.1f} {}V{:.1f}", points.front()[0], top, y);
  for (const auto &[x, at] : points) {
    if (at <= y) continue;
    path += fmt::format("H{:.1f}V{:.1f}", x, at);
    y = at;
  }
  return fmt::format(
      "<path d=\"{}H{}\" stroke=\"#c3ccd5\" stroke-width=\"5\" stroke-linejoin=\"round\" fill=\"none\"/>\n", path,
      right);
}

EarlierCurve::EarlierCurve(const Outcome &outcome, const Curve &curve, double percent) {
  for (const std::size_t p : curve.points)
    if (outcome.earlier && outcome.earlier->points[p]) {
      costs_.push_back(outcome.earlier->points[p]->cost_ms);
      errors_.push_back(percent * outcome.earlier->points[p]->error);
    }
}

std::string EarlierCurve::draw(const Axis &x, const Axis &y, const std::string &colour) const {
  std::string path, dots;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", x.at(costs_[i]), y.at(errors_[i]));
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n", x.at(costs_[i]),
                        y.at(errors_[i]), colour);
  }
  if (path.empty()) return {};
  return fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"1.2\" stroke-dasharray=\"3 3\" fill=\"none\"/>\n",
                     path, colour) +
         dots;
}

std::string earlierSample(double x, double y) {
  return fmt::format(
      "<path d=\"M{0:.1f} {1:.1f}h16\" stroke=\"{2}\" stroke-width=\"1.2\" stroke-dasharray=\"3 3\"/>\n"
      "<circle cx=\"{3:.1f}\" cy=\"{1:.1f}\" r=\"2\" fill=\"{2}\"/>\n",
      x, y, kQuiet, x + 8);
}

std::string shownName(const EarlierRun &run) { return "before: " + run.version + ", " + run.date; }

std::vector<std::size_t> styleIndices(const Study &study, const Plan &plan, const std::vector<Curve> &curves) {
  std::vector<std::string> labels;
  for (std::size_t c = 0; c < study.cases.size(); ++c)
    for (const Curve &curve : curvesOf(study, plan, c))
      if (std::find(labels.begin(), labels.end(), curve.label) == labels.end()) labels.push_back(curve.label);
  std::vector<std::size_t> looks;
  for (const Curve &curve : curves)
    looks.push_back(static_cast<std::size_t>(std::find(labels.begin(), labels.end(), curve.label) - labels.begin()));
  return looks;
}

}  // namespace c3de::study
