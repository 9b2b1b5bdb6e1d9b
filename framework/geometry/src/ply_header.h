// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

/// Refuses headers that break assimp's PLY reader: it does not return for a truncated or malformed header, and it
/// accepts any stated number of elements.
[[nodiscard]] Expected<void> checkPlyHeader(const std::string &fileName, std::string_view text);

}  // namespace c3de::geometry
