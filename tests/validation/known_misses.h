// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace validation {

/// Why the limit of a row is missed at present, or null. Limits stay as they are asked for; what is here waits to be
/// mended. Empty `quantity`: a row that has no value at all.
[[nodiscard]] const char *knownMiss(const std::string &body, const std::string &quantity);

}  // namespace validation
