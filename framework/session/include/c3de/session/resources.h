// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/scene/materials.h"

namespace c3de::session {

/// The file of that name among the resources, for example "scenes/first_light.toml": beside the installed program
/// (../share/c3de), else in the source tree that the program was built from. The error says where it was looked for.
[[nodiscard]] Expected<std::filesystem::path> findResource(const std::filesystem::path &name);

/// The presets of resources/materials.toml. The error says where that file was looked for, or which line is wrong.
[[nodiscard]] Expected<scene::MaterialLibrary> loadMaterialPresets();

/// What opens when no file is named: a brain in its head, or, where that scene cannot be opened, an organ.
struct DefaultScene {
  std::filesystem::path file;
  std::string notice;  ///< why it is the organ, and how to get the scan if that is missing; empty: it is the head
};
[[nodiscard]] Expected<DefaultScene> findDefaultScene();

}  // namespace c3de::session
