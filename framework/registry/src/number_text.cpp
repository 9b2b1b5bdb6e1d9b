// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/number_text.h"

#include <charconv>
#include <cstring>

namespace c3de::registry {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<double> parseNumber(std::string_view text, std::string_view unit) {
  text = trimmed(text);
  if (!unit.empty() && text.ends_with(unit)) text = trimmed(text.substr(0, text.size() - unit.size()));
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool copyText(char *buffer, std::uint64_t capacity, std::string_view text) {
  if (!buffer || capacity == 0) return false;
  std::size_t length = text.size();
  const bool fits = length < capacity;
  if (!fits) {
    length = static_cast<std::size_t>(capacity - 1);
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u) --length;
  }
  std::memcpy(buffer, text.data(), length);
  buffer[length] = '\0';
  return fits;
}

std::string_view bufferText(const char *buffer, std::uint64_t capacity) {
  if (!buffer) return {};
  const void *zero = std::memchr(buffer, 0, static_cast<std::size_t>(capacity));
  return {buffer, zero ? static_cast<std::size_t>(static_cast<const char *>(zero) - buffer)
                       : static_cast<std::size_t>(capacity)};
}

}  // namespace c3de::registry
