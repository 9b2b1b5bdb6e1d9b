// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"

namespace c3de::app {

/// The file of that name among the resources, for example "scenes/first_light.toml": beside the installed program
/// (../share/c3de), else in the source tree that the program was built from. The error says where it was looked for.
[[nodiscard]] Expected<std::filesystem::path> findResource(const std::filesystem::path &name);

/// What opens when no file is named.
inline constexpr const char *kDefaultScene = "scenes/first_light.toml";

}  // namespace c3de::app
