// SPDX-License-Identifier: Apache-2.0
// Pictures on the clipboard. The toolkit of the window can only copy text, so a program of the desktop does it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::app {

/// Command line that puts a PNG from its standard input on the clipboard.
struct ClipboardProgram {
  std::vector<std::string> arguments;
};
/// xclip, or wl-copy in a Wayland session. None: neither is installed, or the system has another clipboard (Windows).
[[nodiscard]] std::optional<ClipboardProgram> findClipboardProgram();
/// What is missing, and what to do instead.
[[nodiscard]] std::string whyNoClipboard();
/// Errors (ErrorCode::output): the program cannot be started, or reports a failure. Any thread.
[[nodiscard]] Expected<void> copyPng(const ClipboardProgram &program, const std::vector<char> &png);

}  // namespace c3de::app
