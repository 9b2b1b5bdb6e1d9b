// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace c3de::render {

/// One character, one byte of coverage per pixel, top row first.
struct GlyphBitmap {
  int width = 0, height = 0;
  int left = 0, top = 0;  ///< from the pen on the base line, y down
  float advance = 0.0f;
  std::vector<std::uint8_t> coverage;
};

class FontRasterizer {
 public:
  virtual ~FontRasterizer() = default;
  /// None: the font does not have the character.
  [[nodiscard]] virtual std::optional<GlyphBitmap> rasterize(char32_t character) const = 0;
  [[nodiscard]] virtual float ascent() const = 0;      ///< px above the base line
  [[nodiscard]] virtual float lineHeight() const = 0;  ///< px
};

/// Null if the bytes are not a TrueType font.
[[nodiscard]] std::unique_ptr<FontRasterizer> loadTrueTypeFont(std::vector<char> file, float pixelHeight);
/// ASCII and look-alikes of °, ², ³, µ, ×; for machines without fonts.
[[nodiscard]] std::unique_ptr<FontRasterizer> loadBuiltInFont(float pixelHeight);

}  // namespace c3de::render
