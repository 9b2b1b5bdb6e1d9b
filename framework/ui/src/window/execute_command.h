// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "frame/frame_context.h"

namespace c3de::ui {

/// Answers in WindowState: the program is to end, after the session was saved.
inline const std::pair<std::string, std::string> kQuit{"quit", "quit"}, kSaveAndQuit{"quit", "save"};

/// Whether what the command needs is present.
[[nodiscard]] bool isEnabled(const FrameContext &frame, const CommandInfo &info);
/// Why it is not enabled, in a sentence; empty: it is.
[[nodiscard]] std::string whyDisabled(const FrameContext &frame, const CommandInfo &info);
/// Executes a command of a menu, button or key. No effect if it is not enabled.
void executeCommand(FrameContext &frame, Command command);

/// One dialog for both kinds of files.
void openSceneOrSession(FrameContext &frame);

/// Saves to the session's file, or to one that the user chooses.
/// @param saved  called after it is complete on the disk; may be empty
void saveSession(FrameContext &frame, bool asksForFile, std::function<void()> saved = {});

}  // namespace c3de::ui
