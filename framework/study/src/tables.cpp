// SPDX-License-Identifier: Apache-2.0
// A study as CSV and as JSON.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "c3de/core/csv.h"
#include "c3de/core/file_path.h"
#include "c3de/core/text.h"
#include "c3de/study/outcome.h"

namespace c3de::study {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> leversOf(const Plan &plan) {
  std::vector<std::string> names;
  for (const Point &point : plan.points)
    for (const StudyParameterValue &value : point.parameters)
      if (std::find(names.begin(), names.end(), value.parameter) == names.end()) names.push_back(value.parameter);
  return names;
}

/// Every error with its column and unit.
struct Column {
  const char *name;
  std::optional<double> Errors::*of;
};
constexpr Column kErrors[]{{"value", &Errors::value},
                           {"error", &Errors::quantity},
                           {"field_l2", &Errors::fieldL2},
                           {"surface_max_mm", &Errors::surfaceMax_mm},
                           {"surface_95_mm", &Errors::surface95_mm},
                           {"energy_norm", &Errors::energyNorm},
                           {"reaction", &Errors::reaction},
                           {"frequency", &Errors::frequency},
                           {"volume_change", &Errors::volumeChange},
                           {"energy_drift_1_s", &Errors::energyDrift_1_s},
                           {"momentum_round_off", &Errors::momentumRoundOff}};

struct CostColumn {
  const char *name;
  double Cost::*of;
};
constexpr CostColumn kCosts[]{{"cost_ms", &Cost::median},       {"cost_least_ms", &Cost::cheapest},
                              {"cost_most_ms", &Cost::dearest}, {"step_median_ms", &Cost::stepMedian_ms},
                              {"step_99_ms", &Cost::step99_ms}, {"step_max_ms", &Cost::stepMax_ms},
                              {"cpu_s", &Cost::cpu_s},          {"to_first_step_s", &Cost::toFirstStep_s}};

std::string labelOf(const Study &study, const Point &point) {
  return point.isReference ? "reference" : study.cases[point.ofCase].grids[point.grid].label;
}

Json numberOrNull(const std::optional<double> &value) { return value ? Json(*value) : Json(nullptr); }

Json truthJson(const ReferenceSolution &truth) {
  Json json{{"kind", truth.kind}, {"source", truth.from}};
  if (truth.value) json["value"] = *truth.value;
  json["uncertainty"] = truth.uncertainty;
  json["bar"] = truth.bar;
  if (truth.order) json["order"] = std::isfinite(*truth.order) ? Json(*truth.order) : Json(nullptr);
  return json;
}

}  // namespace

std::string tableOf(const Study &study, const Plan &plan, const Outcome &outcome) {
  const std::vector<std::string> parameters = leversOf(plan);
  std::string text = "case,label";
  for (const std::string &parameter : parameters) text += ',' + csvCell(parameter);
  text += ",id,outcome,reason";
  for (const Column &column : kErrors) text += std::string(",") + column.name;
  text += ",below_bar,steps,time_s,dt_s,integrated_by,state_hash";
  for (const CostColumn &column : kCosts) text += std::string(",") + column.name;
  text += outcome.earlier ? ",on_front,earlier_error,earlier_cost_ms\n" : ",on_front\n";
  for (std::size_t p = 0; p < plan.points.size(); ++p) {
    const Point &point = plan.points[p];
    const PointOutcome &is = outcome.points[p];
    text += csvCell(study.cases[point.ofCase].name) + ',' + csvCell(labelOf(study, point));
    for (const std::string &parameter : parameters) {
      const auto found = std::find_if(point.parameters.begin(), point.parameters.end(),
                                      [&](const StudyParameterValue &value) { return value.parameter == parameter; });
      text += ',' + (found == point.parameters.end() ? "" : csvCell(withoutQuotes(found->value)));
    }
    text += ',' + point.id + ',' + (is.failure.empty() ? "done" : csvCell(is.failure)) + ',' + csvCell(is.reason);
    for (const Column &column : kErrors)
      text += ',' + ((is.errors.*column.of) ? formatNumber(*(is.errors.*column.of)) : "");
    if (is.cost) {
      text += std::string(is.isBelowResolution ? ",1" : ",0") + ',' + std::to_string(is.steps) + ',' +
              formatNumber(is.time_s) + ',' + formatNumber(is.dt_s) + ',' + csvCell(is.integrator) + ',' + is.stateHash;
      for (const CostColumn &column : kCosts) text += ',' + formatNumber((*is.cost).*column.of);
      text += is.isOnFront ? ",1" : ",0";
    } else {
      text += ",,,,,,";
      for (std::size_t i = 0; i < std::size(kCosts); ++i) text += ',';
      text += ',';
    }
    if (outcome.earlier) {
      const auto &before = outcome.earlier->points[p];
      text += before ? ',' + formatNumber(before->error) + ',' + formatNumber(before->cost_ms) : ",,";
    }
    text += '\n';
  }
  return text;
}

std::string jsonOf(const Study &study, const Plan &plan, const Program &program, const Outcome &outcome) {
  Json json{{"format", 1},
            {"title", study.title},
            {"study", genericPathText(study.source)},
            {"date", outcome.date},
            {"machine", {{"host", outcome.host}, {"cpu", outcome.cpu}, {"processors", outcome.processors}}},
            {"program", {{"version", program.version}, {"build", program.build}}},
            {"seed", study.seed},
            {"repeat", study.repeat},
            {"cases", Json::array()}};
  if (const auto &earlier = outcome.earlier)
    json["compared_with"] = {{"version", earlier->version}, {"date", earlier->date}, {"cpu", earlier->cpu}};
  for (std::size_t c = 0; c < study.cases.size(); ++c) {
    const CaseOutcome &of = outcome.cases[c];
    Json one{{"name", study.cases[c].name},
             {"scene", genericPathText(study.cases[c].scene)},
             {"quantity", study.cases[c].quantity.shown()},
             {"unit", study.cases[c].quantity.unit()},
             {"error_unit", study.cases[c].quantity.kind == Quantity::Kind::surface ? "mm" : "1"},
             {"cost_unit", of.hasTime ? "ms per simulated second" : "ms per solution"}};
    if (of.truth) one["reference"] = truthJson(*of.truth);
    if (!of.error.empty()) one["failure"] = of.error;
    one["points"] = Json::array();
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      const Point &point = plan.points[p];
      const PointOutcome &is = outcome.points[p];
      if (point.ofCase != c) continue;
      Json row{{"id", point.id}, {"label", labelOf(study, point)}, {"levers", Json::object()}};
      for (const StudyParameterValue &value : point.parameters)
        row["levers"][value.parameter] = withoutQuotes(value.value);
      row["set"] = Json::object();
      for (const Setting &setting : point.settings) row["set"][setting.path] = setting.value;
      row["threads"] = point.threads;
      if (!is.failure.empty()) row["failure"] = Json{{"kind", is.failure}, {"reason", is.reason}};
      if (is.cost) {
        for (const Column &column : kErrors) row[column.name] = numberOrNull(is.errors.*column.of);
        row["below_bar"] = is.isBelowResolution;
        row["steps"] = is.steps;
        row["time_s"] = is.time_s;
        row["dt_s"] = is.dt_s;
        row["integrated_by"] = is.integrator;
        row["state_hash"] = is.stateHash;
        for (const CostColumn &column : kCosts) row[column.name] = (*is.cost).*column.of;
        row["on_front"] = is.isOnFront;
      }
      if (outcome.earlier && outcome.earlier->points[p])
        row["earlier"] = {{"error", outcome.earlier->points[p]->error},
                          {"cost_ms", outcome.earlier->points[p]->cost_ms}};
      one["points"].push_back(std::move(row));
    }
    json["cases"].push_back(std::move(one));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace c3de::study
