// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "window/frame_context.h"

namespace c3de::ui {

/// Of WindowState: the program is to end.
inline const std::pair<std::string, std::string> kQuit{"quit", "quit"};

/// What menus, buttons and keys ask for. Nothing happens where what it needs is not there.
void carryOut(FrameContext &frame, Command command);

}  // namespace c3de::ui
