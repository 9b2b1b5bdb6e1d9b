// SPDX-License-Identifier: Apache-2.0
// Whole files and numbers in them, independent of the locale.
#pragma once

#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::geometry {

[[nodiscard]] std::string displayPath(const std::filesystem::path &path);  ///< UTF-8
[[nodiscard]] std::string lowerExtension(const std::filesystem::path &path);

/// Refused: missing, a folder, unreadable, empty, more than 1 GiB.
[[nodiscard]] Expected<std::string> readWholeFile(const std::filesystem::path &path);

/// In quotes, truncated to fit into a message, with non-printable characters replaced.
[[nodiscard]] std::string quotedText(std::string_view text);

enum class NumberState { ok, notANumber, notFinite };

/// The whole token as a number; "1e999", "nan" and "inf" are notFinite.
[[nodiscard]] NumberState parseNumber(std::string_view token, double &value);
[[nodiscard]] bool parseInteger(std::string_view token, long long &value);

}  // namespace c3de::geometry
