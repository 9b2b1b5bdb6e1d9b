// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "c3de/study/report.h"

namespace c3de::study {
namespace {

bool isText(const StudyParameter &parameter) {
  return std::any_of(parameter.values.begin(), parameter.values.end(), [](const std::string &value) {
    return value.front() == '"' || value == "true" || value == "false";
  });
}

/// "damping" for "solver.damping".
std::string shortName(const std::string &parameter) {
  const std::size_t dot = parameter.rfind('.');
  return dot == std::string::npos ? parameter : parameter.substr(dot + 1);
}

std::string shownWithName(const StudyParameterValue &value) {
  const bool saysItself = value.parameter == "spacing" || value.parameter == "evaluation" || value.parameter == "law" ||
                          value.parameter == "integrator" || value.parameter == "precision" ||
                          value.parameter == "simulator";
  return (saysItself ? "" : shortName(value.parameter) + " ") + shownValue(value);
}

const Grid &gridOf(const Study &study, const Point &point) { return study.cases[point.ofCase].grids[point.grid]; }

/// Label from the study parameters with several values: either those with texts or those with numbers.
std::string labelOf(const Study &study, const Point &point, bool ofTexts, std::size_t leastValues = 2) {
  std::string text;
  for (const StudyParameter &parameter : gridOf(study, point).parameters) {
    if (parameter.values.size() < leastValues || isText(parameter) != ofTexts) continue;
    for (const StudyParameterValue &value : point.parameters)
      if (value.parameter == parameter.name) text += (text.empty() ? "" : ", ") + shownWithName(value);
  }
  return text;
}

}  // namespace

std::vector<Curve> curvesOf(const Study &study, const Plan &plan, std::size_t ofCase) {
  std::vector<Curve> curves;
  std::vector<std::pair<std::size_t, std::string>> keys;
  for (std::size_t p = 0; p < plan.points.size(); ++p) {
    const Point &point = plan.points[p];
    if (point.ofCase != ofCase || point.isReference) continue;
    const std::pair key{point.grid, labelOf(study, point, true)};
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found != keys.end()) {
      curves[static_cast<std::size_t>(found - keys.begin())].points.push_back(p);
      continue;
    }
    keys.push_back(key);
    const std::string &label = gridOf(study, point).label;
    std::string name = label + (label.empty() || key.second.empty() ? "" : ", ") + key.second;
    if (name.empty()) name = labelOf(study, point, true, 1);
    if (name.empty())
      for (const StudyParameter &parameter : gridOf(study, point).parameters)
        name += (name.empty() ? "" : ", ") + shortName(parameter.name);
    curves.push_back({name, {p}});
  }
  return curves;
}

std::string pointLabel(const Study &study, const Point &point) {
  const std::string text = labelOf(study, point, false);
  if (!text.empty()) return text;
  const std::string ofTexts = labelOf(study, point, true);
  return ofTexts.empty() ? shownWithName(point.parameters.front()) : ofTexts;
}

std::string commonParameter(const Study &study, std::size_t ofCase) {
  std::string common;
  for (const Grid &grid : study.cases[ofCase].grids)
    for (const StudyParameter &parameter : grid.parameters) {
      if (parameter.values.size() < 2 || isText(parameter)) continue;
      if (!common.empty() && parameter.name != common) return {};
      common = parameter.name;
    }
  return common == "spacing" ? "" : shortName(common);
}

std::string threeDigits(double value) {
  std::array<char, 32> text{};
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size >= 1e-3 && size < 1e5) {
    const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size) + 1e-9)), 0, 6);
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  } else {
    std::snprintf(text.data(), text.size(), "%.2e", value);
  }
  return text.data();
}

std::string shownKind(const std::string &kind) {
  if (kind == "finite_elements") return "finite elements";
  return kind == "richardson" ? "Richardson extrapolation" : kind;
}

std::string escaped(const std::string &text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

}  // namespace c3de::study
