// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::session {

/// From now on the first Ctrl-C or SIGTERM is only recorded, so that a run can finish with its report. A second one
/// terminates the program immediately. Every SIGHUP is recorded, unless it was ignored before (nohup).
void watchForInterrupt();
[[nodiscard]] bool wasInterrupted();

}  // namespace c3de::session
