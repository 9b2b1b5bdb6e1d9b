// SPDX-License-Identifier: Apache-2.0
#include "font_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>

#include "font_rasterizer.h"

namespace c3de::render {
namespace {

constexpr int kAtlasWidth = 512;  // for small text; as many times as much for larger
constexpr float kSmallText_px = 18.0f;
constexpr int kOutline = 2;             // px around the glyph
constexpr int kPadding = kOutline + 1;  // plus one empty pixel, for linear filtering

/// Ranges needed for labels of a medical workstation: Latin with °, ², ³, µ, ×; Greek; dashes, quotes and ellipsis;
/// super- and subscripts; arrows; a few mathematical signs.
constexpr std::array<std::array<char32_t, 2>, 10> kRanges{{{0x20, 0x7E},
                                                           {0xA0, 0x17F},
                                                           {0x391, 0x3C9},
                                                           {0x2010, 0x2026},
                                                           {0x2030, 0x2033},
                                                           {0x2070, 0x208E},
                                                           {0x2190, 0x2195},
                                                           {0x2202, 0x221E},
                                                           {0x2248, 0x2265},
                                                           {0xFFFD, 0xFFFD}}};

std::vector<char> readFile(const std::filesystem::path &path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// First by preference of the name, then by order of the folders.
std::filesystem::path findFont(std::span<const std::filesystem::path> directories) {
  constexpr std::array<const char *, 8> kNames{
      "DejaVuSans.ttf", "segoeui.ttf", "NotoSans-Regular.ttf", "LiberationSans-Regular.ttf", "Ubuntu-R.ttf",
      "arial.ttf",      "Arial.ttf",   "FreeSans.ttf"};
  std::filesystem::path best;
  std::size_t bestRank = kNames.size();
  for (const auto &directory : directories) {
    std::error_code error;
    std::filesystem::recursive_directory_iterator file(
        directory, std::filesystem::directory_options::skip_permission_denied, error);
    for (; !error && file != std::filesystem::recursive_directory_iterator(); file.increment(error)) {
      const auto name = file->path().filename();  // compared as a path: its text may not be convertible
      const auto rank = static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin());
      if (rank >= bestRank) continue;
      best = file->path();
      bestRank = rank;
    }
  }
  return best;
}

/// Copies the glyph into the atlas and surrounds it with its outline: every pixel gets the maximum coverage near it,
/// fading over the last pixel.
void stamp(FontAtlas &atlas, const Glyph &glyph, const GlyphBitmap &bitmap) {
  const auto coverage = [&](int x, int y) -> int {
    if (x < 0 || y < 0 || x >= bitmap.width || y >= bitmap.height) return 0;
    return bitmap.coverage[static_cast<std::size_t>(y * bitmap.width + x)];
  };
  for (int y = 0; y < glyph.height; ++y)
    for (int x = 0; x < glyph.width; ++x) {
      float outline = 0.0f;
      for (int dy = -kOutline; dy <= kOutline; ++dy)
        for (int dx = -kOutline; dx <= kOutline; ++dx) {
          const float distance = std::sqrt(static_cast<float>(dx * dx + dy * dy));
          const float fade = std::clamp(static_cast<float>(kOutline) + 0.3f - distance, 0.0f, 1.0f);
          outline = std::max(outline, fade * static_cast<float>(coverage(x - kPadding + dx, y - kPadding + dy)));
        }
      const auto pixel = 2 * (static_cast<std::size_t>(glyph.y + y) * static_cast<std::size_t>(atlas.width) +
                              static_cast<std::size_t>(glyph.x + x));
      atlas.pixels[pixel] = static_cast<std::uint8_t>(coverage(x - kPadding, y - kPadding));
      atlas.pixels[pixel + 1] = static_cast<std::uint8_t>(outline);
    }
}

}  // namespace

const Glyph &FontAtlas::glyph(char32_t character) const {
  const auto found = glyphs.find(character);
  return found != glyphs.end() ? found->second : glyphs.at(U'?');
}

FontAtlas buildFontAtlas(std::span<const std::filesystem::path> fontDirectories, float pixelHeight) {
  std::unique_ptr<FontRasterizer> font;
  FontAtlas atlas;
  if (const auto path = findFont(fontDirectories); !path.empty()) {
    font = loadTrueTypeFont(readFile(path), pixelHeight);
    const std::u8string name = path.u8string();
    atlas.font.assign(name.begin(), name.end());
  }
  if (!font) {
    font = loadBuiltInFont(pixelHeight);
    atlas.font = "built-in";
  }
  atlas.width = kAtlasWidth * std::max(1, static_cast<int>(std::ceil(pixelHeight / kSmallText_px)));
  atlas.ascent = font->ascent();
  atlas.lineHeight = font->lineHeight();

  // Rows from the top; a new row is as high as its highest glyph.
  int penX = 0, penY = 0, rowHeight = 0;
  for (const auto &[first, last] : kRanges)
    for (char32_t character = first; character <= last; ++character) {
      const std::optional<GlyphBitmap> bitmap = font->rasterize(character);
      if (!bitmap) continue;
      Glyph glyph;
      glyph.advance = bitmap->advance;
      if (bitmap->width > 0 && bitmap->height > 0) {
        glyph.width = bitmap->width + 2 * kPadding;
        glyph.height = bitmap->height + 2 * kPadding;
        if (penX + glyph.width > atlas.width) {
          penX = 0;
          penY += rowHeight;
          rowHeight = 0;
        }
        glyph.x = penX;
        glyph.y = penY;
        glyph.left = static_cast<float>(bitmap->left - kPadding);
        glyph.top = static_cast<float>(bitmap->top - kPadding);
        penX += glyph.width;
        rowHeight = std::max(rowHeight, glyph.height);
        atlas.height = penY + rowHeight;
        atlas.pixels.resize(std::size_t{2} * static_cast<std::size_t>(atlas.width) *
                            static_cast<std::size_t>(atlas.height));
        stamp(atlas, glyph, *bitmap);
      }
      atlas.glyphs.emplace(character, glyph);
    }
  atlas.glyphs.try_emplace(U'?');  // a damaged font may lack even this one
  return atlas;
}

std::u32string decodeUtf8(std::string_view text) {
  constexpr char32_t kReplacement = 0xFFFD;
  std::u32string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) {
      result.push_back(lead);
      continue;
    }
    const int extra = lead < 0xC2 || lead >= 0xF5 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    char32_t value = extra == 0 ? kReplacement : lead & (0x3Fu >> extra);
    std::size_t next = i;
    for (int k = 0; k < extra; ++k, ++next) {
      if (next >= text.size() || (static_cast<unsigned char>(text[next]) & 0xC0u) != 0x80u) {
        value = kReplacement;
        break;
      }
      value = (value << 6) | (static_cast<unsigned char>(text[next]) & 0x3Fu);
    }
    if (value != kReplacement) i = next;
    result.push_back(value);
  }
  return result;
}

}  // namespace c3de::render
