// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace c3de {

/// Changes to the rounding mode, traps and locale of a thread that plugin calls (PluginCall) have left: one line for
/// each owner, also logged as an error. They are reverted after the call. An outermost call begins with the rounding
/// mode and the locale of the program. Any thread.
[[nodiscard]] std::vector<std::string> environmentFaults();

}  // namespace c3de
