// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "window/frame_context.h"

namespace c3de::ui {

/// There are messages or running jobs to show below the panels.
[[nodiscard]] bool isDockNeeded(const FrameContext &frame);

}  // namespace c3de::ui
