// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/interrupt.h"

#include <csignal>

namespace c3de::session {
namespace {

// A signal handler takes no argument, so this one flag has to be static.
volatile std::sig_atomic_t interrupted = 0;

extern "C" void noteInterrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void watchForInterrupt() {
  std::signal(SIGINT, noteInterrupt);
  std::signal(SIGTERM, noteInterrupt);
}

bool wasInterrupted() { return interrupted != 0; }

}  // namespace c3de::session
