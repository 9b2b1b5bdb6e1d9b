// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "c3de/abi/base.h"

namespace c3de {

/// The candidate with the smallest edit distance; empty if none is close (distance above a third of the length).
[[nodiscard]] std::string nearestName(std::string_view name, std::span<const std::string> candidates);

[[nodiscard]] bool isUtf8(std::string_view text) noexcept;

enum class Lines { one, many };
/// Untrusted text for display. Terminal control characters and bidirectional controls are spelt out ("\x1b", "\u202e"),
/// and so are bytes that are not UTF-8 ("\xff"). Line ends: one space, or unchanged.
[[nodiscard]] std::string displayText(std::string_view text, Lines lines = Lines::one);
/// A message that quotes untrusted text: as displayText(), in one line; the middle of a very long one is omitted.
[[nodiscard]] std::string displayMessage(std::string_view text);

/// Locale-independent shortest text that reads back as the same number.
[[nodiscard]] std::string formatNumber(double value);

[[nodiscard]] inline c3de_str toAbi(std::string_view s) { return {s.data(), s.size()}; }
[[nodiscard]] inline std::string_view fromAbi(c3de_str s) {
  return s.ptr ? std::string_view(s.ptr, static_cast<std::size_t>(s.len)) : std::string_view();
}

}  // namespace c3de
