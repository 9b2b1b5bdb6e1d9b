// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/session/run_options.h"

namespace c3de::app {

/// Simulates a scene without a window and writes the requested outputs. Returns the exit code.
[[nodiscard]] int runScene(const RunOptions &options);

}  // namespace c3de::app
