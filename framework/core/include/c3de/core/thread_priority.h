// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de {

/// From now on the calling thread yields to the interactive threads of the program, if more threads are runnable than
/// there are processors; otherwise it loses nothing. Cannot be reverted. No effect on systems without thread
/// priorities.
void lowerThreadPriority();

}  // namespace c3de
