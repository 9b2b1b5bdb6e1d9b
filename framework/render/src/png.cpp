// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "c3de/core/output_file.h"
#include "c3de/render/picture_file.h"
#include "c3de/render/png_file.h"
#include "c3de/render/renderer.h"

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // unused functions of the library
#endif
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

namespace c3de::render {
namespace {

// The default of 8 takes two to three times as long for files that are hardly smaller.
constexpr int kCompressionLevel = 4;

void append(void *context, void *data, int size) {
  const auto *bytes = static_cast<const char *>(data);
  auto &out = *static_cast<std::vector<char> *>(context);
  out.insert(out.end(), bytes, bytes + size);
}

Expected<void> checkSize(const Image &image) {
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width > 0 && image.height > 0 && image.rgb.size() == 3 * pixels) return {};
  return fail(ErrorCode::internal, fmt::format("the image has {} bytes, {} x {} pixels need 3 bytes each",
                                               image.rgb.size(), image.width, image.height));
}

tl::unexpected<Error> notEncoded(const Image &image, const char *format) {
  return fail(ErrorCode::output,
              fmt::format("encoding {} x {} pixels as {} failed (out of memory?)", image.width, image.height, format));
}

Expected<std::vector<char>> encode(const Image &image) {
  if (const auto good = checkSize(image); !good) return tl::unexpected(good.error());
  // The library's only setting is a global; set once so that several threads may write.
  [[maybe_unused]] static const bool configured = [] {
    stbi_write_png_compression_level = kCompressionLevel;
    return true;
  }();
  std::vector<char> bytes;
  if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), 3 * image.width) == 0)
    return notEncoded(image, "PNG");
  return bytes;
}

void appendBigEndian(std::vector<char> &out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(value >> shift & 0xffu));
}

/// CRC-32 of a PNG chunk: reflected polynomial 0xEDB88320. ISO/IEC 15948, annex D.
std::uint32_t chunkCrc(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

}  // namespace

Expected<void> writePng(const std::string &path, const Image &image) {
  const auto bytes = encode(image);
  if (!bytes) return fail(bytes.error().code, fmt::format("cannot write '{}': {}", path, bytes.error().message));
  return writeWholeFile(std::filesystem::path(std::u8string(path.begin(), path.end())), {bytes->data(), bytes->size()});
}

Expected<std::vector<char>> encodePng(const Image &image, double pixelsPerInch) {
  constexpr double kMetresPerInch = 0.0254;
  if (pixelsPerInch != 0.0 && !(pixelsPerInch >= 0.1 && pixelsPerInch <= 1e6))
    return fail(ErrorCode::internal, fmt::format("{} pixels per inch; accepted: 0.1 to 1000000", pixelsPerInch));
  auto bytes = encode(image);
  if (!bytes || pixelsPerInch == 0.0) return bytes;
  const auto perMetre = static_cast<std::uint32_t>(std::lround(pixelsPerInch / kMetresPerInch));
  constexpr std::size_t kAfterHeader = 8 + 25;  // the signature and the chunk IHDR
  constexpr std::uint32_t kContentBytes = 9;
  std::vector<char> chunk;
  appendBigEndian(chunk, kContentBytes);
  for (const char letter : {'p', 'H', 'Y', 's'}) chunk.push_back(letter);
  appendBigEndian(chunk, perMetre);
  appendBigEndian(chunk, perMetre);
  chunk.push_back(1);  // per metre
  appendBigEndian(chunk, chunkCrc({chunk.data() + 4, 4 + kContentBytes}));
  bytes->insert(bytes->begin() + kAfterHeader, chunk.begin(), chunk.end());
  return bytes;
}

Expected<std::vector<char>> encodeJpeg(const Image &image, int quality) {
  if (const auto good = checkSize(image); !good) return tl::unexpected(good.error());
  if (quality < 1 || quality > 100)
    return fail(ErrorCode::internal, fmt::format("JPEG quality {}; accepted: 1 to 100", quality));
  std::vector<char> bytes;
  if (stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), quality) == 0)
    return notEncoded(image, "JPEG");
  return bytes;
}

}  // namespace c3de::render
