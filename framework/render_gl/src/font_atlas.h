// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace c3de::render {

/// The position of a character in the atlas and relative to the base line. Pixels; y down.
struct Glyph {
  int x = 0, y = 0, width = 0, height = 0;  ///< rectangle in the atlas, including the margin for the outline
  float left = 0.0f, top = 0.0f;            ///< of the rectangle, from the pen position on the base line
  float advance = 0.0f;
};

/// Pictures of the characters used in labels: two bytes per pixel, the glyph's coverage and that of its outline.
struct FontAtlas {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< 2 * width * height
  std::map<char32_t, Glyph> glyphs;  ///< always contains '?'
  float ascent = 0.0f, lineHeight = 0.0f;
  std::string font;  ///< file, or the name of the built-in font
  /// The glyph of the character, or of '?'.
  [[nodiscard]] const Glyph &glyph(char32_t character) const;
};

/// Draws the characters with the first known sans-serif font found in or below the folders, otherwise with a small
/// built-in one. Takes some tens of milliseconds.
[[nodiscard]] FontAtlas buildFontAtlas(std::span<const std::filesystem::path> fontDirectories, float pixelHeight);

/// Malformed bytes become U+FFFD, one each.
[[nodiscard]] std::u32string decodeUtf8(std::string_view text);

}  // namespace c3de::render
