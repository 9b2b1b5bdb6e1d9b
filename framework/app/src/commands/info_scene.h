// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/session/session.h"
#include "commands/info_image.h"

namespace c3de::app {

/// Describes the contents of a scene, checked as for a run.
/// @param toml     TOML text to read instead of `file`, which then only names it in messages; null: the file is read
/// @param isQuick  without building its bodies
[[nodiscard]] Expected<Described> describeScene(Session &session, const std::filesystem::path &file,
                                                const std::string *toml, bool isQuick);

}  // namespace c3de::app
