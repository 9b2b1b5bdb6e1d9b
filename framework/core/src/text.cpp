// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace c3de {
namespace {

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

/// Bytes of the character that begins at i; 0: there is none.
std::size_t characterLength(std::string_view text, std::size_t i) noexcept {
  const auto lead = static_cast<unsigned char>(text[i]);
  const std::size_t more = lead < 0x80                   ? 0
                           : lead >= 0xc2 && lead < 0xe0 ? 1
                           : (lead & 0xf0) == 0xe0       ? 2
                           : lead >= 0xf0 && lead < 0xf5 ? 3
                                                         : 4;
  if (more == 4 || i + more >= text.size()) return 0;
  for (std::size_t k = 1; k <= more; ++k)
    if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return 0;
  // The second byte determines over-long forms, surrogates and code points beyond U+10FFFF.
  const auto second = more > 0 ? static_cast<unsigned char>(text[i + 1]) : 0u;
  if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second >= 0xa0) || (lead == 0xf0 && second < 0x90) ||
      (lead == 0xf4 && second >= 0x90))
    return 0;
  return more + 1;
}

/// Of a character of at most three bytes; 0 for longer ones, none of which is a control.
unsigned codePoint(std::string_view character) noexcept {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(character[k]); };
  switch (character.size()) {
    case 1: return byte(0);
    case 2: return (byte(0) & 0x1fu) << 6 | (byte(1) & 0x3fu);
    case 3: return (byte(0) & 0x0fu) << 12 | (byte(1) & 0x3fu) << 6 | (byte(2) & 0x3fu);
    default: return 0x10000;
  }
}

/// Controls (C0, DEL, C1), line and paragraph separators, directional embeddings, overrides and isolates.
bool steers(unsigned code) noexcept {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

bool isUtf8(std::string_view text) noexcept {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = characterLength(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

std::string displayText(std::string_view text, Lines lines) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = characterLength(text, i);
    if (length == 0) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
      ++i;
      continue;
    }
    const std::string_view character = text.substr(i, length);
    i += length;
    const unsigned code = codePoint(character);
    if (code == '\n' || code == '\t') {
      out += lines == Lines::many ? static_cast<char>(code) : ' ';
    } else if (code == '\r' && text.substr(i, 1) == "\n") {
      continue;  // the line end of Windows
    } else if (steers(code)) {
      out += code < 0x80 ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
    } else {
      out += character;
    }
  }
  return out;
}

std::string displayMessage(std::string_view text) {
  constexpr std::size_t kWhole = 2000, kHead = 400, kTail = 600;  // bytes: lists of accepted values are at the end
  if (text.size() <= kWhole) return displayText(text);
  // Not within a character.
  const auto boundary = [&](std::size_t at) {
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) ++at;
    return at;
  };
  return displayText(text.substr(0, boundary(kHead))) + " … " + displayText(text.substr(boundary(text.size() - kTail)));
}

std::string nearestName(std::string_view name, std::span<const std::string> candidates) {
  std::string best;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string &candidate : candidates) {
    const std::size_t shorter = std::min(name.size(), candidate.size()),
                      longer = std::max(name.size(), candidate.size());
    if (longer - shorter >= bestDistance) continue;  // the distance is at least that
    const std::size_t distance = editDistance(name, candidate);
    if (distance < bestDistance) {
      bestDistance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string formatNumber(double value) { return fmt::format("{}", value); }

}  // namespace c3de
