// SPDX-License-Identifier: Apache-2.0
#include "file_text.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"

namespace c3de::geometry {

std::string displayPath(const std::filesystem::path &path) { return pathText(path); }

std::string lowerExtension(const std::filesystem::path &path) {
  std::string extension = displayPath(path.extension());
  for (char &c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

Expected<std::string> readWholeFile(const std::filesystem::path &path) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;
  const std::string name = displayPath(path);
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::input, name + ": cannot be read: " + error.message());
  if (size == 0) return fail(ErrorCode::input, name + ": the file is empty (0 bytes)");
  if (size > kMaxBytes)
    return fail(ErrorCode::input,
                fmt::format("{}: {} bytes; meshes of up to {} bytes (1 GiB) are accepted", name, size, kMaxBytes));
  std::string text(static_cast<std::size_t>(size), '\0');
  in->read(text.data(), static_cast<std::streamsize>(size));
  if (!*in) return fail(ErrorCode::input, name + ": cannot be read (permission, or it changed while it was read)");
  return text;
}

std::string quotedText(std::string_view text) {
  constexpr std::size_t kMax = 40;
  std::string out = "'";
  for (char c : text.substr(0, kMax)) out += (c >= ' ' && c != 127) ? c : '?';
  return out + (text.size() > kMax ? "...'" : "'");
}

NumberState parseNumber(std::string_view token, double &value) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (end != token.data() + token.size() || token.empty()) return NumberState::notANumber;
  if (error == std::errc::result_out_of_range) {
    // Too large or too small for a double: only the sign of the exponent shows which, and 1e-999 is a valid zero.
    const std::size_t exponent = token.find_first_of("eE");
    const bool tiny =
        exponent != std::string_view::npos ? token.substr(exponent + 1).starts_with('-') : token.find('.') <= 2;
    value = 0.0;
    return tiny ? NumberState::ok : NumberState::notFinite;
  }
  if (error != std::errc()) return NumberState::notANumber;
  return std::isfinite(value) ? NumberState::ok : NumberState::notFinite;
}

bool parseInteger(std::string_view token, long long &value) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  return error == std::errc() && end == token.data() + token.size() && !token.empty();
}

}  // namespace c3de::geometry
