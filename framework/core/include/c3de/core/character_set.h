// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de {

/// An encoding of text by the names that platforms give it.
struct CharacterSet {
  const char *iconvName = "";  ///< POSIX
  unsigned codePage = 0;       ///< Win32
};

/// Text as UTF-8. Bytes that are not of the set become U+FFFD, as do all above 127 where the platform does not know the
/// set. Any thread.
[[nodiscard]] std::string utf8From(std::string_view bytes, const CharacterSet &set);

}  // namespace c3de
