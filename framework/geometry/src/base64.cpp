// SPDX-License-Identifier: Apache-2.0
#include "base64.h"

#include <array>
#include <cstdint>

namespace c3de::geometry {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string toBase64(std::string_view bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = bytes.size() - i < 3 ? bytes.size() - i : 3;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out.push_back(k <= n ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

std::optional<std::string> fromBase64(std::string_view text) {
  std::array<signed char, 256> valueOf{};
  valueOf.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    valueOf[static_cast<unsigned char>(kDigits[i])] = static_cast<signed char>(i);
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  std::size_t digits = 0, padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {
      if (digits < 2) return std::nullopt;
      ++padding;
    } else {
      const int value = valueOf[static_cast<unsigned char>(c)];
      if (value < 0 || padding > 0) return std::nullopt;
      bits = bits << 6 | static_cast<std::uint32_t>(value);
      ++digits;
    }
    if (digits + padding < 4) continue;
    bits <<= 6 * padding;
    for (std::size_t k = 0; k + 1 < digits; ++k) out.push_back(static_cast<char>(bits >> (16 - 8 * k) & 255));
    bits = 0;
    digits = padding = 0;
  }
  if (digits + padding != 0) return std::nullopt;
  return out;
}

}  // namespace c3de::geometry
