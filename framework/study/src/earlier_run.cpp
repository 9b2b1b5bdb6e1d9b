// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/earlier_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "c3de/core/input_file.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"

namespace c3de::study {
namespace {

using Json = nlohmann::json;

std::string textIn(const Json &json, const char *key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

const Json &objectIn(const Json &json, const char *key) {
  static const Json kNone = Json::object();
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : kNone;
}

/// Identifies a point among those of its case: label of its grid and values of its study parameters.
using Key = std::pair<std::string, std::map<std::string, std::string>>;

Key keyOf(const Study &study, const Point &point) {
  Key key{study.cases[point.ofCase].grids[point.grid].label, {}};
  for (const StudyParameterValue &value : point.parameters) key.second[value.parameter] = withoutQuotes(value.value);
  return key;
}

std::map<Key, EarlierRun::Point> pointsIn(const Json &of) {
  std::map<Key, EarlierRun::Point> points;
  const auto rows = of.find("points");
  if (rows == of.end() || !rows->is_array()) return points;
  for (const Json &row : *rows) {
    if (!row.is_object() || row.contains("failure")) continue;
    const auto error = row.find("error"), cost = row.find("cost_ms");
    if (error == row.end() || cost == row.end() || !error->is_number() || !cost->is_number()) continue;
    Key key{textIn(row, "label"), {}};
    for (const auto &[parameter, value] : objectIn(row, "levers").items())
      if (value.is_string()) key.second[parameter] = value.get<std::string>();
    points[key] = {error->get<double>(), cost->get<double>()};
  }
  return points;
}

}  // namespace

Expected<EarlierRun> loadEarlierRun(const std::filesystem::path &folder, const Study &study, const Plan &plan) {
  const std::filesystem::path file = folder / "study.json";
  auto in = openInputFile(file);
  if (!in)
    return fail(ErrorCode::input, pathText(file) + ": is not there; accepted: the folder of a study that has ended");
  const Json json = Json::parse(*in, nullptr, false);
  if (!json.is_object() || !json.contains("cases") || !json["cases"].is_array())
    return fail(ErrorCode::input, pathText(file) + ": is no study; accepted: what c3de study has written");
  EarlierRun run{
      textIn(objectIn(json, "program"), "version"), textIn(json, "date"), textIn(objectIn(json, "machine"), "cpu"), {}};
  run.points.resize(plan.points.size());
  bool isAny = false;
  for (const Json &of : json["cases"]) {
    if (!of.is_object()) continue;
    const auto found = std::find_if(study.cases.begin(), study.cases.end(),
                                    [&](const Case &one) { return one.name == textIn(of, "name"); });
    if (found == study.cases.end()) continue;
    if (textIn(of, "quantity") != found->quantity.shown()) {
      log(LogLevel::warn, fmt::format("{}: case '{}' compares {}, this study {}: it is left out", pathText(file),
                                      found->name, textIn(of, "quantity"), found->quantity.shown()));
      continue;
    }
    const auto points = pointsIn(of);
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      if (plan.points[p].isReference || &study.cases[plan.points[p].ofCase] != &*found) continue;
      const auto same = points.find(keyOf(study, plan.points[p]));
      if (same == points.end()) continue;
      run.points[p] = same->second;
      isAny = true;
    }
  }
  if (!isAny)
    return fail(ErrorCode::usage, pathText(file) +
                                      ": has no point of this study; accepted: a study with cases, labels "
                                      "and study parameters of the same names and values");
  return run;
}

}  // namespace c3de::study
