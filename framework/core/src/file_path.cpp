// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/file_path.h"

#include <algorithm>
#include <cwctype>
#include <string>
#include <type_traits>

namespace c3de {
namespace {

namespace fs = std::filesystem;

bool isSeparator(wchar_t c) { return c == L'\\' || c == L'/'; }

bool isEqualText(std::wstring_view a, std::wstring_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](wchar_t x, wchar_t y) { return std::towlower(x) == std::towlower(y); });
}

/// End of the component that begins at `from`, and after a separator.
std::size_t endOfComponent(std::wstring_view text, std::size_t from) {
  while (from < text.size() && !isSeparator(text[from])) ++from;
  return from;
}

template <class Character>
std::size_t uncRootLengthOf(const std::basic_string<Character> &path) {
  if constexpr (std::is_same_v<Character, wchar_t>) return uncRootLength(path);
  return 0;
}
std::size_t uncRootLengthOf(const fs::path &path) { return uncRootLengthOf(path.native()); }

/// A UNC root with separators of the system, and the path from there, which begins with one or is empty.
struct Split {
  fs::path share, rest;
};
Split splitAt(std::size_t length, const fs::path &path) {
  Split out;
  out.share = path.native().substr(0, length);
  out.share.make_preferred();
  out.rest = path.native().substr(length);
  return out;
}

}  // namespace

std::size_t uncRootLength(std::wstring_view text) {
  if (text.size() < 3 || !isSeparator(text[0]) || !isSeparator(text[1]) || isSeparator(text[2])) return 0;
  const std::size_t first = endOfComponent(text, 2);
  const std::wstring_view name = text.substr(2, first - 2);
  std::size_t end = first;
  int further = 1;  // components
  if (name == L"?" || name == L".") {
    end = std::min(text.size(), first + 1);
    end = endOfComponent(text, end);
    const std::wstring_view device = text.substr(std::min(first + 1, text.size()), end - std::min(first + 1, end));
    further = isEqualText(device, L"UNC") ? 2 : 0;
    if (device.empty()) return 0;
  }
  for (; further > 0; --further) {
    if (end + 1 >= text.size() || isSeparator(text[end + 1])) return 0;
    end = endOfComponent(text, end + 1);
  }
  return end;
}

bool isAbsolutePath(const fs::path &path) { return path.is_absolute() || uncRootLengthOf(path) > 0; }

fs::path joinedPath(const fs::path &folder, const fs::path &path) {
  return uncRootLengthOf(path) > 0 ? path : folder / path;
}

fs::path normalPath(const fs::path &path) {
  const std::size_t length = uncRootLengthOf(path);
  if (length == 0) return path.lexically_normal();
  Split split = splitAt(length, path);
  split.share += split.rest.lexically_normal();
  return split.share;
}

fs::path absolutePath(const fs::path &path, std::error_code &error) {
  error.clear();
  if (uncRootLengthOf(path) > 0) return path;
  fs::path absolute = fs::absolute(path, error);
  return error ? path : absolute;
}

fs::path absolutePath(const fs::path &path) {
  std::error_code ignored;
  return absolutePath(path, ignored);
}

fs::path canonicalPath(const fs::path &path, std::error_code &error) {
  const fs::path absolute = absolutePath(path, error);
  if (error) return {};
  return uncRootLengthOf(absolute) > 0 ? normalPath(absolute) : fs::weakly_canonical(absolute, error);
}

fs::path relativePath(const fs::path &path, const fs::path &base) {
  const std::size_t length = uncRootLengthOf(path), ofBase = uncRootLengthOf(base);
  if (length == 0 && ofBase == 0) return path.lexically_relative(base);
  if (length == 0 || ofBase == 0) return {};
  const Split one = splitAt(length, path), other = splitAt(ofBase, base);
  return isEqualText(one.share.wstring(), other.share.wstring())
             ? one.rest.relative_path().lexically_relative(other.rest.relative_path())
             : fs::path();
}

std::string genericPathText(const fs::path &path) {
  const std::size_t length = uncRootLengthOf(path);
  const Split split = splitAt(length, path);
  // The library's own conversion of a share drops a separator.
  const std::u8string share = split.share.u8string(), rest = split.rest.generic_u8string();
  std::string text(share.begin(), share.end());
  if (length > 0) std::replace(text.begin(), text.end(), '\\', '/');
  return text.append(rest.begin(), rest.end());
}

}  // namespace c3de
