// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

/// What every file in LPS millimetres says in its head.
inline constexpr std::string_view kFrameText = "SPACE=LPS UNITS=mm";

/// Writes beside the file and takes its place when all is written: a file appears complete or not at all.
[[nodiscard]] Expected<void> writeWholeFile(const std::filesystem::path &path, std::string_view bytes);

}  // namespace c3de::geometry
