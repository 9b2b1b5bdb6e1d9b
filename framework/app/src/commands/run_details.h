// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/session/preparation.h"
#include "c3de/session/run_options.h"

namespace c3de::scene {
struct SceneFile;
}

namespace c3de::app {

/// What --verbose prints about a scene that has been read: file, title, bodies, overrides.
[[nodiscard]] std::string describe(const scene::SceneFile &scene, const RunOptions &options);
/// And about its bodies once they are built: times, s.
[[nodiscard]] std::string describe(const Preparation &took);

/// ErrorCode::usage: pictures are not written with this extension; it names the accepted ones.
[[nodiscard]] Expected<void> checkPictureFormat(const std::filesystem::path &file);

}  // namespace c3de::app
