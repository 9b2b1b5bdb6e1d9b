// SPDX-License-Identifier: Apache-2.0
#include "font_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // unused functions of the libraries
#endif
// Private copies: the libraries are single headers, and a shared build of them is not available on every system.
#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb_truetype.h>

#include <stb_easy_font.h>

namespace c3de::render {
namespace {

class TrueTypeFont final : public FontRasterizer {
 public:
  /// isValid() returns whether the file could be used.
  TrueTypeFont(std::vector<char> file, float pixelHeight) : file_(std::move(file)) {
    const auto *bytes = reinterpret_cast<const unsigned char *>(file_.data());
    // The smallest font has a 12-byte header and some tables; the parser itself does not check lengths.
    if (file_.size() < 256) return;
    const int offset = stbtt_GetFontOffsetForIndex(bytes, 0);
    if (offset < 0 || stbtt_InitFont(&info_, bytes, offset) == 0) return;
    scale_ = stbtt_ScaleForPixelHeight(&info_, pixelHeight);
    stbtt_GetFontVMetrics(&info_, &ascent_, &descent_, &lineGap_);
    valid_ = true;
  }
  [[nodiscard]] bool isValid() const { return valid_; }

  std::optional<GlyphBitmap> rasterize(char32_t character) const override {
    const int index = stbtt_FindGlyphIndex(&info_, static_cast<int>(character));
    if (index == 0) return std::nullopt;
    GlyphBitmap bitmap;
    int advance = 0, bearing = 0, x1 = 0, y1 = 0;
    stbtt_GetGlyphHMetrics(&info_, index, &advance, &bearing);
    bitmap.advance = scale_ * static_cast<float>(advance);
    stbtt_GetGlyphBitmapBox(&info_, index, scale_, scale_, &bitmap.left, &bitmap.top, &x1, &y1);
    bitmap.width = std::max(0, x1 - bitmap.left);
    bitmap.height = std::max(0, y1 - bitmap.top);
    bitmap.coverage.resize(static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height));
    if (!bitmap.coverage.empty())
      stbtt_MakeGlyphBitmap(&info_, bitmap.coverage.data(), bitmap.width, bitmap.height, bitmap.width, scale_, scale_,
                            index);
    return bitmap;
  }
  float ascent() const override { return scale_ * static_cast<float>(ascent_); }
  float lineHeight() const override { return scale_ * static_cast<float>(ascent_ - descent_ + lineGap_); }

 private:
  std::vector<char> file_;
  stbtt_fontinfo info_{};
  float scale_ = 1.0f;
  int ascent_ = 0, descent_ = 0, lineGap_ = 0;
  bool valid_ = false;
};

/// Rectangles on a coarse grid, enlarged by an integer factor.
class BuiltInFont final : public FontRasterizer {
 public:
  explicit BuiltInFont(float pixelHeight) : zoom_(std::max(1, static_cast<int>(std::lround(pixelHeight / kLine)))) {}

  std::optional<GlyphBitmap> rasterize(char32_t character) const override {
    char text[2] = {lookAlike(character), '\0'};
    if (text[0] == '\0') return std::nullopt;
    struct Corner {
      float x, y, z;
      unsigned char colour[4];
    };
    Corner corners[4 * 64];
    const int quads = stb_easy_font_print(0.0f, 0.0f, text, nullptr, corners, sizeof(corners));
    GlyphBitmap bitmap;
    bitmap.advance = static_cast<float>(zoom_ * stb_easy_font_width(text));
    if (quads == 0) return bitmap;
    int columns = 0, rows = 0;
    for (int i = 0; i < 4 * quads; ++i) {
      columns = std::max(columns, static_cast<int>(std::ceil(corners[i].x)));
      rows = std::max(rows, static_cast<int>(std::ceil(corners[i].y)));
    }
    bitmap.width = zoom_ * columns;
    bitmap.height = zoom_ * rows;
    bitmap.top = -static_cast<int>(ascent());
    bitmap.coverage.resize(static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height));
    for (int q = 0; q < quads; ++q) {
      const Corner &low = corners[4 * q], &high = corners[4 * q + 2];
      for (int y = zoom_ * static_cast<int>(low.y); y < zoom_ * static_cast<int>(high.y); ++y)
        for (int x = zoom_ * static_cast<int>(low.x); x < zoom_ * static_cast<int>(high.x); ++x)
          bitmap.coverage[static_cast<std::size_t>(y * bitmap.width + x)] = 255;
    }
    return bitmap;
  }
  float ascent() const override { return static_cast<float>(8 * zoom_); }
  float lineHeight() const override { return static_cast<float>(12 * zoom_); }

 private:
  static constexpr float kLine = 11.0f;
  static char lookAlike(char32_t c) {
    if (c >= 0x20 && c < 0x7F) return static_cast<char>(c);
    switch (c) {
      case 0xA0: return ' ';
      case 0xB0: return 'o';  // °
      case 0xB2: return '2';  // ²
      case 0xB3: return '3';  // ³
      case 0xB5:
      case 0x3BC: return 'u';  // µ
      case 0xD7: return 'x';   // ×
      case 0x2010:
      case 0x2011:
      case 0x2012:
      case 0x2013:
      case 0x2014:
      case 0x2212: return '-';
      default: return '\0';
    }
  }
  int zoom_;
};

}  // namespace

std::unique_ptr<FontRasterizer> loadTrueTypeFont(std::vector<char> file, float pixelHeight) {
  auto font = std::make_unique<TrueTypeFont>(std::move(file), pixelHeight);
  return font->isValid() ? std::move(font) : nullptr;
}

std::unique_ptr<FontRasterizer> loadBuiltInFont(float pixelHeight) {
  return std::make_unique<BuiltInFont>(pixelHeight);
}

}  // namespace c3de::render
