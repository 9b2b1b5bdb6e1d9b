// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// The picture of a PNG file of at most 4096 x 4096 pixels and 64 MiB, without its opacity. ErrorCode::input: the file
/// cannot be read, is damaged or too large. Any thread.
[[nodiscard]] Expected<Image> readPng(const std::filesystem::path &file);

}  // namespace c3de::render
