// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace c3de::registry {

/// Parses the input of a number field: a number with a point as decimal sign, optionally followed by the unit.
[[nodiscard]] std::optional<double> parseNumber(std::string_view text, std::string_view unit);

/// Copies text into a plugin's buffer, zero-terminated, never inside a UTF-8 character; false if it was truncated.
bool copyText(char *buffer, std::uint64_t capacity, std::string_view text);

/// Text up to the terminating zero, or up to the capacity if there is none.
[[nodiscard]] std::string_view bufferText(const char *buffer, std::uint64_t capacity);

}  // namespace c3de::registry
