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

/// The state of a simulation as the bytes of a file: a header of the host's (what it is, of which class and version of
/// its plugin, how long, a checksum over all), then what the simulator gives. On the simulation's thread, or before it
/// runs. Errors: the simulator keeps no states, or not this one (its text).
[[nodiscard]] Expected<std::string> stateBytes(Session &session, c3de_object *simulator,
                                               const SimulatorIdentity &identity);
/// Goes to the state of such bytes. On an error, which begins with `name`, nothing has changed: not such a file, cut or
/// damaged, of another class, version or scene.
[[nodiscard]] Expected<void> goToState(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                       std::string_view bytes, const std::string &name);
/// The bytes of a file, up to 16 GiB. Errors name it. Any thread.
[[nodiscard]] Expected<std::string> readStateFile(const std::filesystem::path &file);

}  // namespace c3de::session
