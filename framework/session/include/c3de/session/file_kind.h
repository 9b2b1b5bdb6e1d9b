// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "c3de/core/expected.h"

namespace c3de::geometry {
class MeshFormats;
}

namespace c3de::session {

/// What a file or folder is taken for, by name and first bytes.
enum class FileKind { scene, image, mesh, unknown };

/// @param formats  null, or what plugins read as well
[[nodiscard]] FileKind kindOf(const std::filesystem::path &path, const geometry::MeshFormats *formats = nullptr);
/// Why a file of unknown kind is not opened, and what is accepted (ErrorCode::input).
[[nodiscard]] Error unknownKind(const std::filesystem::path &path, const geometry::MeshFormats *formats = nullptr);

/// What is wrong with a name that is none of a folder of plugins.
[[nodiscard]] std::string notAFolder(const std::filesystem::path &path);

/// What an image is called: its file or folder, never what is in it.
[[nodiscard]] std::string imageName(const std::filesystem::path &path);

}  // namespace c3de::session
