// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "c3de/core/output_file.h"
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

}  // namespace

Expected<void> writePng(const std::string &path, const Image &image) {
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width <= 0 || image.height <= 0 || image.rgb.size() != 3 * pixels)
    return fail(ErrorCode::internal,
                fmt::format("cannot write '{}': the image has {} bytes, {} x {} pixels need 3 bytes each", path,
                            image.rgb.size(), image.width, image.height));
  // The library's only setting is a global; set once so that several threads may write.
  [[maybe_unused]] static const bool configured = [] {
    stbi_write_png_compression_level = kCompressionLevel;
    return true;
  }();
  std::vector<char> bytes;
  if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), 3 * image.width) == 0)
    return fail(ErrorCode::output,
                fmt::format("cannot write '{}': encoding {} x {} pixels as PNG failed (out of memory?)", path,
                            image.width, image.height));
  return writeWholeFile(std::filesystem::path(std::u8string(path.begin(), path.end())), {bytes.data(), bytes.size()});
}

}  // namespace c3de::render
