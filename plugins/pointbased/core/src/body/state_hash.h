// SPDX-License-Identifier: Apache-2.0
// Hash of the dynamic state. Private to the core.
#pragma once

#include <cstdint>

#include "pointbased/body.h"

namespace pointbased::detail {

/// FNV-1a, 64 bit: start value.
inline constexpr std::uint64_t kHashStart = 14695981039346656037ull;

/// Continues a hash with displacements, velocities and material history; after rereferencing, with the reference as
/// well.
[[nodiscard]] std::uint64_t hashOf(const Body &body, std::uint64_t hash);

}  // namespace pointbased::detail
