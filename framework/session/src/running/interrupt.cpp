// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/interrupt.h"

#include <csignal>

namespace c3de::session {
namespace {

// A signal handler has no argument, so this flag has to be static.
volatile std::sig_atomic_t interrupted = 0;

extern "C" void noteInterrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

#ifdef SIGHUP
extern "C" void noteHangUp(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_IGN);  // on closing a terminal, the shell and the kernel send one each
}
#endif

}  // namespace

void watchForInterrupt() {
  std::signal(SIGINT, noteInterrupt);
  std::signal(SIGTERM, noteInterrupt);
#ifdef SIGHUP
  if (std::signal(SIGHUP, noteHangUp) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // as nohup requires
#endif
}

bool wasInterrupted() { return interrupted != 0; }

}  // namespace c3de::session
