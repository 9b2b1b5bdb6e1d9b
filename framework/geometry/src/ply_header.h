// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

/// Refuses what assimp's PLY reader does not survive: it never comes back from a header that is cut off or garbled, and
/// it believes any number of elements.
[[nodiscard]] Expected<void> checkPlyHeader(const std::string &fileName, std::string_view text);

}  // namespace c3de::geometry
