// SPDX-License-Identifier: Apache-2.0
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include "c3de/core/character_set.h"

namespace c3de {

std::string utf8From(std::string_view bytes, const CharacterSet &set) {
  const int length = static_cast<int>(bytes.size());
  const int wideLength = length == 0 ? 0 : MultiByteToWideChar(set.codePage, 0, bytes.data(), length, nullptr, 0);
  std::string out;
  if (wideLength <= 0) {
    for (const char c : bytes) static_cast<unsigned char>(c) < 0x80 ? out += c : out += "\xef\xbf\xbd";
    return out;
  }
  std::wstring wide(static_cast<std::size_t>(wideLength), L'\0');
  MultiByteToWideChar(set.codePage, 0, bytes.data(), length, wide.data(), wideLength);
  const int outLength = WideCharToMultiByte(CP_UTF8, 0, wide.data(), wideLength, nullptr, 0, nullptr, nullptr);
  out.resize(static_cast<std::size_t>(outLength));
  WideCharToMultiByte(CP_UTF8, 0, wide.data(), wideLength, out.data(), outLength, nullptr, nullptr);
  return out;
}

}  // namespace c3de
