// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/session/simulator_identity.h"

namespace c3de::session {

class Session;

/// The state of a simulation as the bytes of a file: a header written by the host (magic, class and version of its
/// plugin, length, a checksum over all), then the state from the simulator. Call on the simulation's thread, or before
/// it runs. Errors: the simulator does not store states, or not this one (its text).
[[nodiscard]] Expected<std::string> stateBytes(Session &session, c3de_object *simulator,
                                               const SimulatorIdentity &identity);
/// Restores the state from such bytes. On an error, which begins with `name`, nothing has changed. Errors: not a state
/// file, truncated or damaged, of another class, version or scene.
[[nodiscard]] Expected<void> goToState(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                       std::string_view bytes, const std::string &name);
/// The bytes of a file of up to 16 GiB. Errors name the file. Any thread.
[[nodiscard]] Expected<std::string> readStateFile(const std::filesystem::path &file);

}  // namespace c3de::session
