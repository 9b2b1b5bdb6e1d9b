// SPDX-License-Identifier: Apache-2.0
// Fields of binary files: little-endian on every machine. Reading never goes beyond the bytes that are there.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace c3de::session {

template <std::unsigned_integral Number>
void putNumber(std::string &out, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i) out += static_cast<char>(number >> (8 * i) & 0xffu);
}

/// Its size before it.
template <std::unsigned_integral Size>
void putText(std::string &out, std::string_view text) {
  putNumber(out, static_cast<Size>(text.size()));
  out += text;
}

inline void putReal(std::string &out, double value) { putNumber(out, std::bit_cast<std::uint64_t>(value)); }

/// Removes the number from the front; none: too few bytes.
template <std::unsigned_integral Number>
std::optional<Number> takeNumber(std::string_view &bytes) {
  if (bytes.size() < sizeof(Number)) return std::nullopt;
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    number |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  bytes.remove_prefix(sizeof(Number));
  return static_cast<Number>(number);
}

template <std::unsigned_integral Size>
std::optional<std::string_view> takeText(std::string_view &bytes) {
  const auto size = takeNumber<Size>(bytes);
  if (!size || *size > bytes.size()) return std::nullopt;
  const std::string_view text = bytes.substr(0, static_cast<std::size_t>(*size));
  bytes.remove_prefix(text.size());
  return text;
}

inline std::optional<double> takeReal(std::string_view &bytes) {
  const auto bits = takeNumber<std::uint64_t>(bytes);
  return bits ? std::optional(std::bit_cast<double>(*bits)) : std::nullopt;
}

}  // namespace c3de::session
