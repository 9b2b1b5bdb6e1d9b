// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/command_line.h"
#include "bench/report.h"
#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace bench {

/// Size of one of four views in a window of 1280 x 800.
inline constexpr int kPaneWidth = 457, kPaneHeight = 357;

/// A scene with an [image], as the window shows it while it plays: each frame performs a step of 1/60 s, queries the
/// displacement from the simulator, uploads it and draws three slices and the 3D view into the bound framebuffer of 2 x
/// 2 panes.
[[nodiscard]] c3de::Expected<void> measureScene(c3de::render::Renderer &renderer, const std::filesystem::path &file,
                                                const Options &options, Report &report);

/// A torso of some ten tissues, written to `folder` by this function and run as in the window: the simulation plays on
/// its own thread, slices and the 3D view are drawn concurrently at no more than 60 frames a second, without and with a
/// colour-mapped field.
[[nodiscard]] c3de::Expected<void> measureLiving(c3de::render::Renderer &renderer, const std::filesystem::path &folder,
                                                 const Options &options, Report &report);

}  // namespace bench
