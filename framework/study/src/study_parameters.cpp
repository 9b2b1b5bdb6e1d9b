// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/study_parameters.h"

#include <charconv>
#include <cmath>
#include <map>

#include "c3de/core/text.h"

namespace c3de::study {
namespace {

/// Of every deformable body.
const std::map<std::string, std::string> kOfBodies{{"spacing", "sampling.spacing"},
                                                   {"count", "sampling.count"},
                                                   {"neighbours", "sampling.neighbours"},
                                                   {"support", "sampling.support"},
                                                   {"evaluation", "sampling.evaluation"},
                                                   {"law", "material.law"},
                                                   {"poisson_ratio", "material.poisson_ratio"}};
const std::map<std::string, std::string> kOfScene{{"integrator", "solver.integrator"},
                                                  {"dt", "solver.dt"},
                                                  {"precision", "solver.precision"},
                                                  {"simulator", "simulator.class"}};
constexpr double kFrame_s = 1.0 / 60.0;

double numberOf(const std::string &text) {
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

bool isNumber(const std::string &text) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size();
}

/// Three digits are enough to distinguish points in print.
std::string rounded(double value) {
  const double scale = value == 0.0 ? 1.0 : std::pow(10.0, 3.0 - std::ceil(std::log10(std::abs(value))));
  return formatNumber(std::round(value * scale) / scale);
}

}  // namespace

std::vector<std::vector<StudyParameterValue>> combinations(const std::vector<StudyParameter> &parameters) {
  std::vector<std::vector<StudyParameterValue>> all{{}};
  for (const StudyParameter &parameter : parameters) {
    std::vector<std::vector<StudyParameterValue>> more;
    for (const auto &before : all)
      for (const std::string &value : parameter.values) {
        more.push_back(before);
        more.back().push_back({parameter.name, value, parameter.line});
      }
    all = std::move(more);
  }
  return all;
}

std::vector<Setting> settingsOf(const StudyParameterValue &value, const std::vector<std::string> &bodies) {
  std::vector<Setting> out;
  if (value.parameter == "threads") return out;
  if (const auto of = kOfBodies.find(value.parameter); of != kOfBodies.end()) {
    for (const std::string &body : bodies) out.push_back({"body." + body + "." + of->second, value.value, value.line});
  } else if (const auto at = kOfScene.find(value.parameter); at != kOfScene.end()) {
    out.push_back({at->second, value.value, value.line});
  } else if (value.parameter == "substeps") {
    out.push_back({"solver.dt", formatNumber(kFrame_s / numberOf(value.value)), value.line});
  } else {
    out.push_back({value.parameter, value.value, value.line});
  }
  return out;
}

std::string withoutQuotes(const std::string &value) {
  return value.size() >= 2 && value.front() == '"' ? value.substr(1, value.size() - 2) : value;
}

std::string shownValue(const StudyParameterValue &value) {
  std::string text = value.value;
  if (text.size() >= 2 && text.front() == '"') return text.substr(1, text.size() - 2);
  if (!isNumber(text)) return text;
  if (value.parameter == "spacing") return rounded(1e3 * numberOf(text)) + " mm";
  if (value.parameter == "dt") return rounded(1e3 * numberOf(text)) + " ms";
  return text;
}

std::string shown(const std::vector<StudyParameterValue> &values) {
  std::string text;
  for (const StudyParameterValue &value : values)
    text += (text.empty() ? "" : ", ") + value.parameter + " " + shownValue(value);
  return text;
}

double refinementOf(const StudyParameterValue &value) {
  const double number = numberOf(value.value);
  if (value.parameter == "count") return 1.0 / std::cbrt(number);
  return value.parameter == "substeps" ? 1.0 / number : number;
}

}  // namespace c3de::study
