// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulation_step.h"

#include "c3de/core/plugin_call.h"
#include "c3de/core/text.h"

namespace c3de::session {

Expected<c3de_status> makeStep(scene::Simulation &simulation, const char *owner) {
  if (const auto ready = simulation.beginStep(); !ready) return tl::unexpected(ready.error());
  return callPluginFunction(owner, "a step of the simulation", CallKind::step,
                            [&] { return simulation.table()->step(simulation.object()); });
}

std::string stepFailure(std::uint64_t stepsBefore, double time_s, bool isLoadStepped, c3de_status code,
                        const std::string &reason) {
  const std::string step = "step " + std::to_string(stepsBefore + 1);
  return (isLoadStepped ? "load " + step : step + " at " + formatNumber(time_s) + " s") +
         " failed: " + (reason.empty() ? "status " + std::to_string(code) : reason);
}

}  // namespace c3de::session
