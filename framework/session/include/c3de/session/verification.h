// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Whether a simulator tells how far its states are off.
[[nodiscard]] bool verifiesStates(const c3de_simulator_v1 *table);
/// The same; the error names it. Asked before hours of work.
[[nodiscard]] Expected<void> checkVerifies(const c3de_simulator_v1 *table, const SimulatorIdentity &identity);

/// What it says of the present state: JSON, as iface.simulator describes it.
/// @param isWanted  asked several times a second; false: ErrorCode::cancelled
[[nodiscard]] Expected<std::string> verification(Session &session, c3de_object *simulator,
                                                 const c3de_simulator_v1 *table,
                                                 const std::function<bool(double, const std::string &)> &isWanted);

/// The same for people, a line per body.
[[nodiscard]] std::vector<std::string> verificationLines(const std::string &verificationJson);
/// How accurate the end state is: the statement of each body in the simulator's report, with what a verification adds.
/// @param verificationJson  may be empty
[[nodiscard]] std::vector<std::string> accuracyLines(const std::string &simulatorJson,
                                                     const std::string &verificationJson);

}  // namespace c3de::session
