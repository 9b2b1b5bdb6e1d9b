// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "frame/frame_context.h"

namespace c3de::ui {

/// Answer in WindowState: the program is to end.
inline const std::pair<std::string, std::string> kQuit{"quit", "quit"};

/// Whether what the command needs is present.
[[nodiscard]] bool isEnabled(const FrameContext &frame, const CommandInfo &info);
/// Executes a command of a menu, button or key. No effect if it is not enabled.
void executeCommand(FrameContext &frame, Command command);

}  // namespace c3de::ui
