// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// What writePicture() accepts, for messages.
inline constexpr const char *kPictureExtensions = ".png, .jpg, .jpeg, .ppm";

/// Whether the extension is one of kPictureExtensions, in small or capital letters, or there is none: then it is PNG.
[[nodiscard]] bool isPictureFile(const std::filesystem::path &file);

/// Writes a picture as its extension says: PNG, JPEG or binary PPM (P6); without an extension PNG.
/// ErrorCode::usage: another extension. ErrorCode::output: the file cannot be written. Any thread.
[[nodiscard]] Expected<void> writePicture(const std::filesystem::path &file, const Image &picture);

/// An image as the content of a JPEG file (baseline, no chroma subsampling).
/// @param quality  1 … 100; lines and letters stay sharp from about 90 on
/// ErrorCode::internal: number of bytes or quality. ErrorCode::output: not enough memory. Any thread.
[[nodiscard]] Expected<std::vector<char>> encodeJpeg(const Image &image, int quality);

}  // namespace c3de::render
