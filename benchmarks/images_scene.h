// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/command_line.h"
#include "bench/report.h"
#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"

namespace bench {

/// Of one of four views in a window of 1280 x 800.
inline constexpr int kPaneWidth = 457, kPaneHeight = 357;

/// A scene with an [image], as the window shows it while it plays: each frame takes a step of 1/60 s, asks the
/// simulator for the displacement, hands it over and draws three slices and the 3D view into the bound framebuffer of 2
/// x 2 panes.
[[nodiscard]] c3de::Expected<void> measureScene(c3de::render::Renderer &renderer, const std::filesystem::path &file,
                                                const Options &options, Report &report);

/// A torso of some ten tissues that this writes to `folder` itself, alive as the window has it: the simulation plays on
/// a thread of its own, slices and the 3D view are drawn beside it at no more than 60 frames a second, without and with
/// a field in colours.
[[nodiscard]] c3de::Expected<void> measureLiving(c3de::render::Renderer &renderer, const std::filesystem::path &folder,
                                                 const Options &options, Report &report);

}  // namespace bench
