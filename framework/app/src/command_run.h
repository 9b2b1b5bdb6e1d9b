// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/session/run_options.h"

namespace c3de::app {

/// `c3de run`: simulates without a window. Returns the exit code.
[[nodiscard]] int runScene(const RunOptions &options);

}  // namespace c3de::app
