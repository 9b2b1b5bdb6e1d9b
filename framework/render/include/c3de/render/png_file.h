// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// The picture of a PNG file of at most 4096 x 4096 pixels and 64 MiB, without its opacity. ErrorCode::input: the file
/// cannot be read, is damaged or too large. Any thread.
[[nodiscard]] Expected<Image> readPng(const std::filesystem::path &file);

/// An image as the content of a PNG file. Its pHYs chunk states the resolution, so that other programs use the physical
/// size.
/// @param pixelsPerInch  stored per metre, as a whole number; 0.1 … 1e6, or 0: no such chunk
/// ErrorCode::internal: number of bytes or resolution. ErrorCode::output: not enough memory. Any thread.
[[nodiscard]] Expected<std::vector<char>> encodePng(const Image &image, double pixelsPerInch);

}  // namespace c3de::render
