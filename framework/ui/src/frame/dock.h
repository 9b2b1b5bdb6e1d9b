// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "frame/frame_context.h"

namespace c3de::ui {

/// Whether there are messages or running jobs to show below the panels.
[[nodiscard]] bool isDockNeeded(const FrameContext &frame);

}  // namespace c3de::ui
