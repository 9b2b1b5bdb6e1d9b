// SPDX-License-Identifier: Apache-2.0
// Text of std::filesystem::path in UTF-8 with mingw-w64: the library decodes a path from std::string by mbrtowc(), which in
// the C locale takes bytes for characters, and this C library has no locale with UTF-8. (It encodes in UTF-8.) The
// linker replaces it by the function here (--wrap). Visual C++ decodes by the code page of the process.
#if defined(__MINGW32__)
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cwchar>

namespace {

constexpr auto kInvalid = static_cast<std::size_t>(-1);
constexpr auto kIncomplete = static_cast<std::size_t>(-2);

std::size_t lengthOf(unsigned char lead) {
  return lead < 0x80                   ? 1
         : lead >= 0xc2 && lead < 0xe0 ? 2
         : lead >= 0xe0 && lead < 0xf0 ? 3
         : lead >= 0xf0 && lead < 0xf5 ? 4
                                       : 0;
}

std::size_t invalid() {
  errno = EILSEQ;
  return kInvalid;
}

}  // namespace

extern "C" std::size_t __wrap_mbrtowc(wchar_t *out, const char *in, std::size_t available, std::mbstate_t *state) {
  if (in == nullptr) return 0;
  if (available == 0) return kIncomplete;
  // A character of four bytes is two of UTF-16: the first takes three bytes and keeps the second in the state.
  if (state != nullptr && *state != 0) {
    if (out != nullptr) *out = static_cast<wchar_t>(*state);
    *state = 0;
    return 1;
  }
  const auto byteAt = [&](std::size_t i) { return static_cast<unsigned char>(in[i]); };
  const std::size_t length = lengthOf(byteAt(0));
  if (length == 0) return invalid();
  std::uint32_t character = length == 1 ? byteAt(0) : byteAt(0) & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (i == available) return kIncomplete;
    if ((byteAt(i) & 0xc0U) != 0x80U) return invalid();
    character = character << 6U | (byteAt(i) & 0x3fU);
  }
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (character < kSmallest[length] || character > 0x10ffff || (character >= 0xd800 && character < 0xe000))
    return invalid();
  if (length < 4) {
    if (out != nullptr) *out = static_cast<wchar_t>(character);
    return character == 0 ? 0 : length;
  }
  if (state == nullptr) return invalid();
  if (out != nullptr) *out = static_cast<wchar_t>(0xd800U + ((character - 0x10000U) >> 10U));
  *state = static_cast<std::mbstate_t>(0xdc00U + ((character - 0x10000U) & 0x3ffU));
  return 3;
}
#endif
