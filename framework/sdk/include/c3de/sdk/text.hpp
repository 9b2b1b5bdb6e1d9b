// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

#include "c3de/abi/base.h"

namespace c3de::sdk {

/// Borrows the text; it must outlive the call it is passed to.
[[nodiscard]] constexpr c3de_str str(std::string_view text) noexcept { return {text.data(), text.size()}; }

/// Borrows what the host lent.
[[nodiscard]] constexpr std::string_view text(c3de_str s) noexcept {
  return s.ptr ? std::string_view(s.ptr, static_cast<std::size_t>(s.len)) : std::string_view();
}

namespace literals {
/// "c3de.log/1"_str, usable in constant tables.
[[nodiscard]] constexpr c3de_str operator""_str(const char *s, std::size_t n) noexcept { return {s, n}; }
}  // namespace literals

/// Collects what the host writes into a c3de_sink.
class TextSink {
 public:
  [[nodiscard]] c3de_sink sink() noexcept { return {this, &TextSink::put}; }
  [[nodiscard]] const std::string &text() const noexcept { return text_; }
  [[nodiscard]] std::string take() noexcept { return std::move(text_); }

 private:
  static c3de_status C3DE_CALL put(void *self, const void *bytes, std::uint64_t n) noexcept {
    try {
      static_cast<TextSink *>(self)->text_.append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
      return C3DE_OK;
    } catch (...) {
      return C3DE_E_NOMEM;
    }
  }
  std::string text_;
};

/// Hands text to a sink that the host gave.
inline c3de_status put(c3de_sink sink, std::string_view bytes) noexcept {
  return sink.put ? sink.put(sink.self, bytes.data(), bytes.size()) : C3DE_E_ARG;
}

}  // namespace c3de::sdk
