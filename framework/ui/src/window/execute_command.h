// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "frame/frame_context.h"

namespace c3de::ui {

/// Answer in WindowState: the program is to end.
inline const std::pair<std::string, std::string> kQuit{"quit", "quit"};

/// Executes a command of a menu, button or key. No effect if what it needs is not present.
void executeCommand(FrameContext &frame, Command command);

}  // namespace c3de::ui
