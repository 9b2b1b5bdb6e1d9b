// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include "c3de/core/thread_priority.h"

namespace c3de {

void lowerThreadPriority() {
#ifdef __linux__
  // Linux has a nice value for each thread; 5 is about a third of the usual share.
  constexpr int kNicer = 5;
  (void)setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNicer);
#endif
}

}  // namespace c3de
