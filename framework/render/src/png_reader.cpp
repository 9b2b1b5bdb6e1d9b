// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

#include "c3de/core/path_text.h"
#include "c3de/render/png_file.h"

#ifdef _MSC_VER
#pragma warning(disable : 4505)  // unused functions of the library
#endif
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 4096
#include <stb_image.h>

namespace c3de::render {

Expected<Image> readPng(const std::filesystem::path &file) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{64} << 20;
  const std::string name = pathText(file);
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (code) return fail(ErrorCode::input, name + ": cannot be read: " + code.message());
  if (size > kMaxBytes)
    return fail(ErrorCode::input,
                fmt::format("{}: has {} bytes; accepted: a PNG of at most {}", name, size, kMaxBytes));
  std::vector<char> bytes(static_cast<std::size_t>(size));
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    return fail(ErrorCode::input, name + ": cannot be read");
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void *)> pixels(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc *>(bytes.data()), static_cast<int>(bytes.size()), &width,
                            &height, &channels, 3),
      stbi_image_free);
  if (!pixels)
    return fail(ErrorCode::input, fmt::format("{}: not a readable PNG ({}); accepted: at most {} x {} pixels", name,
                                              stbi_failure_reason(), STBI_MAX_DIMENSIONS, STBI_MAX_DIMENSIONS));
  const std::size_t count = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return Image{width, height, {pixels.get(), pixels.get() + count}};
}

}  // namespace c3de::render
