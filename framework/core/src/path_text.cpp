// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/path_text.h"

#include <type_traits>

#include "c3de/core/text.h"

namespace c3de {

std::string pathText(const std::filesystem::path &path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

std::filesystem::path pathFromText(const std::string &text) {
  std::u8string utf8(text.begin(), text.end());
  if constexpr (!std::is_same_v<std::filesystem::path::value_type, char>)
    if (!isUtf8(text)) {
      utf8.clear();
      for (const char byte : text)
        if (const auto unit = static_cast<char8_t>(byte); unit < 0x80)
          utf8 += unit;
        else
          utf8 += u8"\ufffd";
    }
  return {utf8};
}

}  // namespace c3de
