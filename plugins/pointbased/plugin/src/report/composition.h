// SPDX-License-Identifier: Apache-2.0
// The stages of which the steps of the bodies consist, for the report and the panel.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "c3de/sdk/panel.hpp"
#include "pointbased/simulator.h"

namespace pointbased {

/// [{"body", "stages": [{"name", "runs", "why", "clock"}]}], in the order of the bodies.
[[nodiscard]] nlohmann::ordered_json compositionJson(const Simulator &simulator);

[[nodiscard]] std::vector<StepComposition> compositionsOf(const Simulator &simulator);

/// Lists the stages that run, the reason, their times where they are measured, and the stages that do not run.
void drawComposition(c3de::sdk::Ui &ui, const std::vector<StepComposition> &bodies,
                     const std::vector<StageClock::Summary> &times);

}  // namespace pointbased
