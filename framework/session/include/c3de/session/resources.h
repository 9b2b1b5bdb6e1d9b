// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/scene/materials.h"

namespace c3de::session {

/// The resource file of that name, for example "scenes/first_light.toml": next to the installed program
/// (../share/c3de), otherwise in the source tree that the program was built from. The error lists the searched
/// locations.
[[nodiscard]] Expected<std::filesystem::path> findResource(const std::filesystem::path &name);

/// The presets of resources/materials.toml. The error lists the searched locations, or the invalid line.
[[nodiscard]] Expected<scene::MaterialLibrary> loadMaterialPresets();

/// The scene opened when no file is named: a brain in its head, or an organ where that scene cannot be opened.
struct DefaultScene {
  std::filesystem::path file;
  std::string notice;  ///< why it is the organ, and how to get a missing scan; empty: it is the head
};
[[nodiscard]] Expected<DefaultScene> findDefaultScene();

}  // namespace c3de::session
