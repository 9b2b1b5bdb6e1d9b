// SPDX-License-Identifier: Apache-2.0
// Text of the last failed call across the ABI boundary, one per thread.
#pragma once

#include <string>
#include <string_view>

#include "c3de/abi/base.h"
#include "c3de/plugin_host/plugin_error.h"

namespace c3de::plugin_host {

void setLastError(std::string_view text) noexcept;
void setLastError(PluginError error) noexcept;
/// Returns and clears it. The text includes the location.
[[nodiscard]] std::string takeLastError() noexcept;
[[nodiscard]] PluginError takeLastErrorAt() noexcept;
/// Whether a function without a return value has reported a failure on this thread; returns the previous value.
bool exchangeCallbackFailed(bool value) noexcept;
/// "C3DE_E_ARG" for -1; the number if it is unknown.
[[nodiscard]] std::string statusName(c3de_status status);

}  // namespace c3de::plugin_host
