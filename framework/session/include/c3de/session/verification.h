// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Whether a simulator can estimate the error of its states.
[[nodiscard]] bool verifiesStates(const c3de_simulator_v1 *table);
/// Same as an error that names the simulator. Checked before hours of work.
[[nodiscard]] Expected<void> checkVerifies(const c3de_simulator_v1 *table, const SimulatorIdentity &identity);

/// The simulator's verification of the present state: JSON, as iface.simulator describes it.
/// @param isWanted  called several times a second; false: ErrorCode::cancelled
[[nodiscard]] Expected<std::string> verification(Session &session, c3de_object *simulator,
                                                 const c3de_simulator_v1 *table,
                                                 const std::function<bool(double, const std::string &)> &isWanted);

/// The same as text for the user, a line per body.
[[nodiscard]] std::vector<std::string> verificationLines(const std::string &verificationJson);
/// The accuracy of the end state: the statement of each body in the simulator's report, with the results of a
/// verification.
/// @param verificationJson  may be empty
[[nodiscard]] std::vector<std::string> accuracyLines(const std::string &simulatorJson,
                                                     const std::string &verificationJson);

}  // namespace c3de::session
