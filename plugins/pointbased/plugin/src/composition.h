// SPDX-License-Identifier: Apache-2.0
// What the steps of the bodies consist of, as the report and the panel say it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "c3de/sdk/panel.hpp"
#include "pointbased/simulator.h"

namespace pointbased {

/// [{"body", "stages": [{"name", "runs", "why", "clock"}]}], in the order of the bodies.
[[nodiscard]] nlohmann::ordered_json compositionJson(const Simulator &simulator);

[[nodiscard]] std::vector<StepComposition> compositionsOf(const Simulator &simulator);

/// The stages that run, why, with what they take where they are measured, and those that do not.
void drawComposition(c3de::sdk::Ui &ui, const std::vector<StepComposition> &bodies,
                     const std::vector<StageClock::Summary> &times);

}  // namespace pointbased
