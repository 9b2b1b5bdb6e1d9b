// SPDX-License-Identifier: Apache-2.0
#include "report/composition.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace pointbased {
namespace {

using Json = nlohmann::ordered_json;

std::string readable(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// "0.12 ms (40 %), 99 %: 0.2 ms"
std::string costOf(const StageClock::Summary &stage, double all) {
  char text[96];
  std::snprintf(text, sizeof text, "%.3f ms (%.0f %%), 99 %%: %.3f ms", stage.median_ms,
                all > 0.0 ? 100.0 * stage.median_ms / all : 0.0, stage.p99_ms);
  return text;
}

}  // namespace

std::vector<StepComposition> compositionsOf(const Simulator &simulator) {
  std::vector<StepComposition> out;
  for (const std::size_t id : simulator.bodyIds()) out.push_back(simulator.stepper().compositionOf(id));
  return out;
}

Json compositionJson(const Simulator &simulator) {
  Json out = Json::array();
  for (const StepComposition &body : compositionsOf(simulator)) {
    Json stages = Json::array();
    for (const ComposedStage &stage : body.stages)
      stages.push_back({{"name", stage.name}, {"runs", stage.runs}, {"why", stage.why}, {"clock", stage.clock}});
    out.push_back({{"body", body.body}, {"stages", std::move(stages)}});
  }
  return out;
}

void drawComposition(c3de::sdk::Ui &ui, const std::vector<StepComposition> &bodies,
                     const std::vector<StageClock::Summary> &times) {
  ui.heading("Stages of a step");
  double all = 0.0;
  for (const StageClock::Summary &stage : times) all += stage.median_ms;
  for (const StageClock::Summary &stage : times) {
    ui.value(readable(stage.name), costOf(stage, all));
    ui.tooltip("Median over the latest steps, of all bodies together, and its share");
  }
  for (const StepComposition &body : bodies) {
    std::string idle;
    for (const ComposedStage &stage : body.stages) {
      if (stage.runs)
        ui.value(body.body + ": " + readable(stage.name), stage.why);
      else
        idle += (idle.empty() ? "" : "; ") + readable(stage.name) + " (" + stage.why + ")";
    }
    ui.text(body.body + ", not in its step: " + (idle.empty() ? "nothing" : idle));
  }
}

}  // namespace pointbased
