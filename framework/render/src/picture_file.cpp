// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"

namespace c3de::render {
namespace {

constexpr int kQuality = 92;

std::string lowerExtension(const std::filesystem::path &file) {
  std::string extension = pathText(file.extension());
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return extension;
}

}  // namespace

bool isPictureFile(const std::filesystem::path &file) {
  const std::string extension = lowerExtension(file);
  return extension.empty() || extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".ppm";
}

Expected<void> writePicture(const std::filesystem::path &file, const Image &picture) {
  const std::string extension = lowerExtension(file);
  if (!isPictureFile(file))
    return fail(ErrorCode::usage,
                fmt::format("{}: '{}' cannot be written; accepted: {}", pathText(file), extension, kPictureExtensions));
  if (extension.empty() || extension == ".png") return writePng(pathText(file), picture);
  if (extension == ".ppm") {
    std::string bytes = fmt::format("P6\n{} {}\n255\n", picture.width, picture.height);
    bytes.append(reinterpret_cast<const char *>(picture.rgb.data()), picture.rgb.size());
    return writeWholeFile(file, bytes);
  }
  const auto bytes = encodeJpeg(picture, kQuality);
  if (!bytes) return fail(bytes.error().code, pathText(file) + ": " + bytes.error().message);
  return writeWholeFile(file, {bytes->data(), bytes->size()});
}

}  // namespace c3de::render
