// SPDX-License-Identifier: Apache-2.0
// The text behind the last failing call through the boundary, one per thread.
#pragma once

#include <string>
#include <string_view>

#include "c3de/abi/base.h"
#include "c3de/plugin_host/plugin_error.h"

namespace c3de::plugin_host {

void setLastError(std::string_view text) noexcept;
void setLastError(PluginError error) noexcept;
/// Clears it. The text names the place, too.
[[nodiscard]] std::string takeLastError() noexcept;
[[nodiscard]] PluginError takeLastErrorAt() noexcept;
/// Whether a function that returns nothing has said that it failed, on this thread; gives what was before.
bool exchangeCallbackFailed(bool value) noexcept;
/// "C3DE_E_ARG" of -1; the number of what is unknown.
[[nodiscard]] std::string statusName(c3de_status status);

}  // namespace c3de::plugin_host
