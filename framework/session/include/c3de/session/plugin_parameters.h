// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/registry/parameter_registry.h"

namespace c3de::session {

/// Sets a parameter that a plugin has declared and notifies its listener.
/// @param assignment  "PLUGIN:ID=VALUE", for example "org.c3de.magnet:strength=20"; a vector as "0,0.3,0". Errors
///                    (ErrorCode::usage) name the nearest plugin or parameter and what is accepted.
[[nodiscard]] Expected<void> setPluginParameter(registry::ParameterRegistry &parameters,
                                                const std::vector<plugin_host::PluginInfo> &plugins,
                                                const std::string &assignment);

}  // namespace c3de::session
