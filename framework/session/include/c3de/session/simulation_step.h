// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "c3de/scene/simulation.h"

namespace c3de::session {

/// Makes one step of a simulation that its caller steps: posted commands, forces of plugins, and the step. Returns the
/// status of the simulator; after a completed step, Simulation::endStep() is next. Errors: why the step could not begin.
/// [sim]
/// @param owner  as Simulation::create()
[[nodiscard]] Expected<c3de_status> makeStep(scene::Simulation &simulation, const char *owner);

/// Why a step failed, for people: "step 12 at 0.5 s failed: reason".
/// @param stepsBefore, time_s  completed before that step
/// @param isLoadStepped        it is a step of the load, which has no time
/// @param reason               text of the simulator; empty: the status is named
[[nodiscard]] std::string stepFailure(std::uint64_t stepsBefore, double time_s, bool isLoadStepped, c3de_status code,
                                      const std::string &reason);

}  // namespace c3de::session
