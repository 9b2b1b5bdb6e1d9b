// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::session {

/// From now on the first Ctrl-C or SIGTERM is only noted, so that a run can finish with its report; a second one ends
/// the program at once. Every SIGHUP is noted, unless it was ignored before (nohup).
void watchForInterrupt();
[[nodiscard]] bool wasInterrupted();

}  // namespace c3de::session
