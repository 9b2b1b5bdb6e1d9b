// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "c3de/registry/parameter_registry.h"

namespace c3de::registry {

/// Rewords a text for the window. Ids of parameters become the labels that the panels show: "solver.dt" is “Step”.
/// Other keys of the same tables lose their table ("contact.pair" is “pair”), and ids of interfaces and classes
/// ("c3de.iface.…/1") are removed. Addresses, file names and numbers are
/// unchanged, and so is a text about a line of a scene file, whose keys are those of the file.
[[nodiscard]] std::string plainWords(std::string_view text, const ParameterRegistry &parameters);

}  // namespace c3de::registry
