// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace validation {

/// Why a row currently misses its limit, or null. Limits are unchanged; these rows await a fix. Empty `quantity`: a row
/// without any value.
[[nodiscard]] const char *knownMiss(const std::string &body, const std::string &quantity);

}  // namespace validation
