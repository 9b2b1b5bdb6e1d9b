// SPDX-License-Identifier: Apache-2.0
#include <iconv.h>

#include <cerrno>

#include "c3de/core/character_set.h"

namespace c3de {
namespace {

constexpr const char *kReplacement = "\xef\xbf\xbd";

}  // namespace

std::string utf8From(std::string_view bytes, const CharacterSet &set) {
  std::string in(bytes), out;
  const iconv_t converter = iconv_open("UTF-8", set.iconvName);
  if (converter == reinterpret_cast<iconv_t>(-1)) {
    for (const char c : in) static_cast<unsigned char>(c) < 0x80 ? out += c : out += kReplacement;
    return out;
  }
  char *from = in.data();
  std::size_t left = in.size();
  while (left > 0) {
    char chunk[256];
    char *to = chunk;
    std::size_t room = sizeof chunk;
    const std::size_t done = iconv(converter, &from, &left, &to, &room);
    const int error = errno;
    out.append(chunk, sizeof chunk - room);
    if (done != static_cast<std::size_t>(-1) || error == E2BIG) continue;
    out += kReplacement;
    ++from;
    --left;
    iconv(converter, nullptr, nullptr, nullptr, nullptr);
  }
  iconv_close(converter);
  return out;
}

}  // namespace c3de
