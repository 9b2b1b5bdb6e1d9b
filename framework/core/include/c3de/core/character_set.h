// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de {

/// A text encoding by its names on the platforms.
struct CharacterSet {
  const char *iconvName = "";  ///< POSIX
  unsigned codePage = 0;       ///< Win32
};

/// Text as UTF-8. Bytes outside the set become U+FFFD, and so do all above 127 if the platform does not support the
/// set. Any thread.
[[nodiscard]] std::string utf8From(std::string_view bytes, const CharacterSet &set);

}  // namespace c3de
