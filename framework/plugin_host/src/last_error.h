// SPDX-License-Identifier: Apache-2.0
// The text behind the last failing call through the boundary, one per thread.
#pragma once

#include <string>
#include <string_view>

#include "c3de/abi/base.h"

namespace c3de::plugin_host {

void setLastError(std::string_view text) noexcept;
/// Clears it.
[[nodiscard]] std::string takeLastError() noexcept;
/// "C3DE_E_ARG" of -1; the number of what is unknown.
[[nodiscard]] std::string statusName(c3de_status status);

}  // namespace c3de::plugin_host
