// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "c3de/core/expected.h"

namespace c3de::geometry {
class MeshFormats;
}

namespace c3de::session {

/// The type of a file or folder, detected by name and first bytes.
enum class FileKind { scene, session, recording, image, mesh, unknown };

/// @param formats  mesh formats that plugins add; may be null
[[nodiscard]] FileKind kindOf(const std::filesystem::path &path, const geometry::MeshFormats *formats = nullptr);
/// Why a file of unknown type, or a recording, is not opened, and which types are accepted (ErrorCode::input).
[[nodiscard]] Error unknownKind(const std::filesystem::path &path, const geometry::MeshFormats *formats = nullptr);

/// Why a path is not a plugin folder.
[[nodiscard]] std::string notAFolder(const std::filesystem::path &path);

/// The display name of an image: that of its file or folder, never taken from its content.
[[nodiscard]] std::string imageName(const std::filesystem::path &path);

}  // namespace c3de::session
