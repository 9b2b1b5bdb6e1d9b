// SPDX-License-Identifier: Apache-2.0
// Names of the members of embedded files.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::session {

inline constexpr std::string_view kEmbedded = "files/";
inline constexpr std::size_t kSha256Digits = 64;

[[nodiscard]] inline bool isHexadecimal(std::string_view text, std::size_t digits) {
  return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Whether it has the form files/SHA256/NAME; the name may have folders.
[[nodiscard]] inline bool isEmbeddedPath(std::string_view path) {
  constexpr std::size_t kName = kEmbedded.size() + kSha256Digits + 1;
  return path.size() > kName && path.starts_with(kEmbedded) && path[kName - 1] == '/' && path.back() != '/' &&
         isHexadecimal(path.substr(kEmbedded.size(), kSha256Digits), kSha256Digits);
}

/// Hash of an embedded file, or of an embedded folder, as that of ReferencedFile.
/// @param hashes  of members, by name
[[nodiscard]] Expected<std::string> embeddedHash(const std::string &name,
                                                 const std::map<std::string, std::string> &hashes);

}  // namespace c3de::session
