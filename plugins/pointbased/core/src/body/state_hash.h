// SPDX-License-Identifier: Apache-2.0
// A fingerprint of what moves. Private to the core.
#pragma once

#include <cstdint>

#include "pointbased/body.h"

namespace pointbased::detail {

/// FNV-1a, 64 bit: start value.
inline constexpr std::uint64_t kHashStart = 14695981039346656037ull;

/// Goes on with displacements, velocities and the memory of the material; with the reference where it has been renewed.
[[nodiscard]] std::uint64_t hashOf(const Body &body, std::uint64_t hash);

}  // namespace pointbased::detail
