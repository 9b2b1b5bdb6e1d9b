// SPDX-License-Identifier: Apache-2.0
// Operations of std::filesystem that also accept UNC paths on Windows: `\\server\share\file` and `\\?\C:\file`. The
// libstdc++ of MinGW-w64 treats these as paths without a root.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace c3de {

/// Length of the root `\\server\share`, `\\?\UNC\server\share` or `\\?\C:`; 0 if there is none.
[[nodiscard]] std::size_t uncRootLength(std::wstring_view path);

[[nodiscard]] bool isAbsolutePath(const std::filesystem::path &path);
/// `folder / path`. An absolute `path` is returned unchanged.
[[nodiscard]] std::filesystem::path joinedPath(const std::filesystem::path &folder, const std::filesystem::path &path);
/// lexically_normal()
[[nodiscard]] std::filesystem::path normalPath(const std::filesystem::path &path);
/// As absolute(). Returns `path` on an error.
[[nodiscard]] std::filesystem::path absolutePath(const std::filesystem::path &path, std::error_code &error);
[[nodiscard]] std::filesystem::path absolutePath(const std::filesystem::path &path);
/// Absolute and normal, without links as far as the path exists; empty on an error. Links in a share are not followed.
[[nodiscard]] std::filesystem::path canonicalPath(const std::filesystem::path &path, std::error_code &error);
/// lexically_relative(): empty where there is none, as between two drives or shares.
[[nodiscard]] std::filesystem::path relativePath(const std::filesystem::path &path, const std::filesystem::path &base);
/// UTF-8, with `/` between the components.
[[nodiscard]] std::string genericPathText(const std::filesystem::path &path);

}  // namespace c3de
